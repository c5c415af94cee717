//! Fault: one known way in which a renderer's picture can differ from ours.

use serde::Serialize;

use crate::agreement::Rounding;
use crate::setup::{OutputChange, Setup};

/// Known difference between another renderer and ours.
#[derive(Clone, Copy, Debug)]
pub struct Fault {
    /// Identifier for files and the command line, in kebab case.
    pub id: &'static str,
    /// What the other renderer does, as a clause in lower case.
    pub name: &'static str,
    /// Whether it is an error or another convention.
    pub kind: Kind,
    /// Decision of the renderer that it concerns. Faults of the same slot exclude each other.
    pub(crate) slot: Slot,
    /// Change of our inputs or of our picture that has the same effect.
    pub(crate) change: Change,
    /// Other changes that have the effect in renderers that clip polygons in other ways.
    pub(crate) variants: &'static [Change],
}

/// Kind of a difference. They differ in what they say about the other renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Error: the picture is wrong.
    Error,
    /// Other convention or setting: correct in itself, but not what was asked for.
    Convention,
    /// Other input: the renderer draws correctly, but not from the same data.
    Input,
}

/// Decision of a renderer. A renderer decides each of them in one way.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Slot {
    Background,
    RowOrder,
    ColumnOrder,
    Channels,
    Encoding,
    Rounding,
    SamplePosition,
    Aspect,
    FieldOfView,
    Handedness,
    NearPlane,
    Coverage,
    Culling,
    DepthTest,
    DepthFormat,
    Interpolation,
    TextureV,
    TextureU,
    TextureWrap,
    TextureFilter,
    TexelOffset,
    TextureAlpha,
    ColorSpace,
    LightDirection,
    Ambient,
    Normals,
    Shading,
    Opacity,
    BlendingOrder,
    Antialiasing,
    Upscaling,
    PostFilter,
}

/// Change that gives our drawing the effect of a fault.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Change {
    /// Settings of the recipe, each as `key=value`.
    Settings(&'static [&'static str]),
    /// Change of scene, camera or recipe.
    Setup(fn(&mut Setup)),
    /// Change of the finished picture.
    Output(OutputChange),
    /// Rounding of the finished colours.
    Rounding(Rounding),
    /// Colour of the finished picture where nothing is drawn, as sRGB codes; `None` in the registry, because it is
    /// measured in a picture.
    Background(Option<[u8; 3]>),
}

impl Fault {
    /// Returns the name as the start of a sentence.
    pub fn title(&self) -> String {
        let mut letters = self.name.chars();
        letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
    }

    /// Returns the settings, each as `key=value`, that have the effect of the fault; `None` if no settings have it.
    pub fn settings(&self) -> Option<&'static [&'static str]> {
        match self.change {
            Change::Settings(settings) => Some(settings),
            Change::Setup(_) | Change::Output(_) | Change::Rounding(_) | Change::Background(_) => None,
        }
    }

    /// Returns whether a drawing with the fault takes several times as long as one without.
    pub(crate) fn is_slow(&self) -> bool {
        self.slot == Slot::Antialiasing
    }

    /// Declares an error.
    pub(crate) const fn error(id: &'static str, name: &'static str, slot: Slot, change: Change) -> Self {
        Self { id, name, kind: Kind::Error, slot, change, variants: &[] }
    }

    /// Declares another convention.
    pub(crate) const fn convention(id: &'static str, name: &'static str, slot: Slot, change: Change) -> Self {
        Self { kind: Kind::Convention, ..Self::error(id, name, slot, change) }
    }

    /// Declares another input.
    pub(crate) const fn input(id: &'static str, name: &'static str, slot: Slot, change: Change) -> Self {
        Self { kind: Kind::Input, ..Self::error(id, name, slot, change) }
    }

    /// Returns the fault with other changes that have its effect.
    pub(crate) const fn or(self, variants: &'static [Change]) -> Self {
        Self { variants, ..self }
    }
}

impl Setup {
    /// Returns the setup with the faults added, in the given order. A difference whose value is measured in a picture,
    /// such as the colour of the background, changes nothing.
    pub fn with<'a>(&self, faults: impl IntoIterator<Item = &'a Fault>) -> Self {
        self.changed(faults.into_iter().map(|fault| fault.change))
    }

    /// Returns the setup with changes, in the given order.
    pub(crate) fn changed(&self, changes: impl IntoIterator<Item = Change>) -> Self {
        let mut changed = self.clone();
        for change in changes {
            changed.add(change);
        }
        changed
    }

    fn add(&mut self, change: Change) {
        match change {
            // The assignments are constants, and a test sets each of them.
            Change::Settings(assignments) => drop(self.recipe.set_all(assignments)),
            Change::Setup(change) => change(self),
            Change::Output(change) => self.output.push(change),
            Change::Rounding(rounding) => self.rounding = rounding,
            Change::Background(color) => self.background = color.or(self.background),
        }
    }
}
