//! Alternatives that a user chooses from, as enums with names and help.

use serde::{Deserialize as _, Deserializer};

/// Setting with a closed set of alternatives that a user chooses from.
pub trait Choice: Copy + PartialEq + 'static {
    /// All alternatives, in the order in which menus list them.
    const ALL: &'static [Self];

    /// Returns the identifier used in files and on the command line, in kebab case.
    fn id(self) -> &'static str;

    /// Returns the display name.
    fn name(self) -> &'static str;

    /// Returns the help text that tooltips and the command line show.
    fn help(self) -> &'static str;

    /// Returns other words for the alternative, in lower case, by which the palette finds it.
    fn synonyms(self) -> &'static [&'static str] {
        &[]
    }
}

/// Declares an enum of alternatives with id, name, help and optional synonyms, and implements [`Choice`] for it.
#[macro_export]
macro_rules! choice {
    ($(#[$meta:meta])* $visibility:vis $enum:ident {
        $($variant:ident = $id:literal, $name:literal, $help:literal $(, also [$($synonym:literal),+])?;)+
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        $visibility enum $enum {
            $(#[doc = $help] #[serde(rename = $id)] $variant,)+
        }

        impl Choice for $enum {
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            fn id(self) -> &'static str {
                match self { $(Self::$variant => $id),+ }
            }

            fn name(self) -> &'static str {
                match self { $(Self::$variant => $name),+ }
            }

            fn help(self) -> &'static str {
                match self { $(Self::$variant => $help),+ }
            }

            fn synonyms(self) -> &'static [&'static str] {
                match self { $(Self::$variant => &[$($($synonym),+)?]),+ }
            }
        }
    };
}

pub use choice;

/// Names of an alternative that is declared in a file of its own.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Label {
    /// Identifier used in files and on the command line, in kebab case.
    pub(crate) id: &'static str,
    /// Display name.
    pub(crate) name: &'static str,
    /// Help text that tooltips and the command line show.
    pub(crate) help: &'static str,
    /// Other words, in lower case, by which the palette finds the alternative.
    pub(crate) synonyms: &'static [&'static str],
}

/// Declares an enum of alternatives whose facts are constants in files of their own, and implements [`Choice`] for it.
/// The facts are structs with a field `label` of type [`Label`].
macro_rules! registry {
    ($(#[$meta:meta])* $visibility:vis $enum:ident: $facts:ty {
        $($variant:ident = $fact:expr;)+
    }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        $visibility enum $enum {
            $(#[doc = concat!("Declared by `", stringify!($fact), "`.")] $variant,)+
        }

        impl $enum {
            /// Returns the facts that the alternative declares about itself.
            #[inline(always)]
            pub(crate) const fn facts(self) -> &'static $facts {
                match self { $(Self::$variant => &$fact),+ }
            }
        }

        impl $crate::pipeline::choice::Choice for $enum {
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            fn id(self) -> &'static str {
                self.facts().label.id
            }

            fn name(self) -> &'static str {
                self.facts().label.name
            }

            fn help(self) -> &'static str {
                self.facts().label.help
            }

            fn synonyms(self) -> &'static [&'static str] {
                self.facts().label.synonyms
            }
        }

        impl serde::Serialize for $enum {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.serialize_str(self.facts().label.id)
            }
        }

        impl<'de> serde::Deserialize<'de> for $enum {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $crate::pipeline::choice::deserialize(deserializer, &[$($fact.label.id),+])
            }
        }
    };
}

pub(crate) use registry;

/// Reads an alternative by its id. `ids` are the ids of all alternatives, which an error message lists.
pub(crate) fn deserialize<'de, C: Choice, D: Deserializer<'de>>(
    deserializer: D,
    ids: &'static [&'static str],
) -> Result<C, D::Error> {
    let id = String::deserialize(deserializer)?;
    let known = C::ALL.iter().copied().find(|choice| choice.id() == id);
    known.ok_or_else(|| serde::de::Error::unknown_variant(&id, ids))
}
