//! Values of settings as text: the values that a setting accepts, and their conversion from and to text.

use std::fmt;
use std::ops::RangeInclusive;

use glam::Vec3;

use crate::antialias::settings::{MaskWeights, centred_in_5x5};
use crate::pipeline::background::Background;
use crate::pipeline::settings::Choice;
use crate::upscale::Scale;

/// Word that a setting accepts as its value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// Word in files and on the command line.
    pub id: String,
    /// Display name, for example in menus.
    pub name: String,
    /// Help text; empty if the name needs none.
    pub help: &'static str,
    /// Other words, in lower case, by which the palette finds the value.
    pub synonyms: &'static [&'static str],
}

impl Word {
    /// Returns a word that is its own display name.
    pub(super) fn plain(id: impl Into<String>) -> Self {
        let id = id.into();
        Self { name: id.clone(), id, help: "", synonyms: &[] }
    }

    /// Returns the word of an alternative.
    pub(super) fn of(choice: impl Choice) -> Self {
        Self {
            id: choice.id().to_owned(),
            name: choice.name().to_owned(),
            help: choice.help(),
            synonyms: choice.synonyms(),
        }
    }
}

/// Form of values that are not listed as words.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueForm {
    /// Number within a range, or any finite number.
    Number(Option<RangeInclusive<f32>>),
    /// Integer from 0 to 2³² − 1.
    Whole,
    /// Integer from 0 to this number, in percent.
    Percent(u32),
    /// List of finite numbers, which has one of these lengths.
    Numbers(&'static [usize]),
    /// Colour in sRGB as `#rrggbb`.
    Color,
}

impl fmt::Display for ValueForm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(None) => f.write_str("number"),
            Self::Number(Some(range)) => write!(f, "number, {}…{}", range.start(), range.end()),
            Self::Whole => f.write_str("whole number"),
            Self::Percent(most) => write!(f, "0…{most} %"),
            Self::Numbers(lengths) => {
                let lengths: Vec<_> = lengths.iter().map(usize::to_string).collect();
                write!(f, "{} comma-separated numbers", lengths.join(" or "))
            }
            Self::Color => f.write_str("#rrggbb"),
        }
    }
}

/// Values that a setting accepts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Values {
    /// Words that are values, such as the names of methods.
    pub words: Vec<Word>,
    /// Form of further values.
    pub form: Option<ValueForm>,
    /// Restriction of the values, in words that follow the list of values; empty if there is none.
    pub restriction: String,
}

impl Values {
    /// Returns values that all have the form `form`.
    pub(super) fn of_form(form: ValueForm) -> Self {
        Self { form: Some(form), ..Self::default() }
    }

    /// Returns values that are words.
    pub(super) fn of_words(words: impl IntoIterator<Item = Word>) -> Self {
        Self { words: words.into_iter().collect(), ..Self::default() }
    }

    /// Returns the values with a restriction that is described in words.
    pub(super) fn restricted(self, restriction: impl Into<String>) -> Self {
        Self { restriction: restriction.into(), ..self }
    }

    /// Whether the values are `true` and `false`.
    pub fn is_switch(&self) -> bool {
        self.words.iter().map(|word| word.id.as_str()).eq(["true", "false"])
    }

    /// Returns the error message for text that is none of the values.
    pub(super) fn refuse(&self, text: &str) -> String {
        format!("`{text}` is not one of {self}")
    }
}

impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let words = self.words.iter().map(|word| word.id.clone());
        let all: Vec<_> = words.chain(self.form.as_ref().map(ValueForm::to_string)).collect();
        f.write_str(&all.join(", "))?;
        if self.restriction.is_empty() { Ok(()) } else { write!(f, ", {}", self.restriction) }
    }
}

/// Type of a setting's value, with its conversion from and to text.
pub(super) trait SettingValue: Sized {
    /// Returns all values of the type, as words or as a form such as a number.
    fn values() -> Values;

    /// Parses a value. Returns an error message that describes the accepted values if there is none with this text.
    fn parse(text: &str) -> Result<Self, String>;

    /// Returns the text from which [`Self::parse`] restores the value bit for bit.
    fn text(&self) -> String;

    /// Whether all numbers of the value are finite.
    fn is_finite(&self) -> bool {
        true
    }
}

impl<C: Choice> SettingValue for C {
    fn values() -> Values {
        Values::of_words(C::ALL.iter().copied().map(Word::of))
    }

    /// Parses the id of an alternative, which may be written with `_` in place of `-`.
    fn parse(text: &str) -> Result<Self, String> {
        let id = text.replace('_', "-");
        C::ALL.iter().copied().find(|choice| choice.id() == id).ok_or_else(|| Self::values().refuse(text))
    }

    fn text(&self) -> String {
        self.id().to_owned()
    }
}

impl SettingValue for bool {
    fn values() -> Values {
        Values::of_words(["true", "false"].map(Word::plain))
    }

    fn parse(text: &str) -> Result<Self, String> {
        match text {
            "true" | "on" | "yes" => Ok(true),
            "false" | "off" | "no" => Ok(false),
            _ => Err(format!("`{text}` is neither true nor false")),
        }
    }

    fn text(&self) -> String {
        self.to_string()
    }
}

impl SettingValue for u32 {
    fn values() -> Values {
        Values::of_form(ValueForm::Whole)
    }

    fn parse(text: &str) -> Result<Self, String> {
        text.parse().map_err(|_| format!("`{text}` is not a whole number"))
    }

    fn text(&self) -> String {
        self.to_string()
    }
}

impl SettingValue for f32 {
    fn values() -> Values {
        Values::of_form(ValueForm::Number(None))
    }

    fn parse(text: &str) -> Result<Self, String> {
        let number = text.trim().parse().ok().filter(|number: &Self| number.is_finite());
        number.ok_or_else(|| format!("`{text}` is not a number"))
    }

    fn text(&self) -> String {
        self.to_string()
    }

    fn is_finite(&self) -> bool {
        Self::is_finite(*self)
    }
}

/// Parses a list of comma-separated numbers. Returns the list that `fit` makes of them, or an error message if it
/// returns `None`.
fn parse_list<T: SettingValue>(text: &str, fit: impl Fn(&[f32]) -> Option<T>) -> Result<T, String> {
    let numbers = text.split(',').map(f32::parse).collect::<Result<Vec<_>, _>>()?;
    let expected = || T::values().to_string();
    fit(&numbers).ok_or_else(|| format!("expected {}, not `{text}`", expected()))
}

fn list_text(numbers: &[f32]) -> String {
    numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(",")
}

impl SettingValue for Vec3 {
    fn values() -> Values {
        Values::of_form(ValueForm::Numbers(&[3]))
    }

    fn parse(text: &str) -> Result<Self, String> {
        parse_list(text, |numbers| <[f32; 3]>::try_from(numbers).ok().map(Self::from))
    }

    fn text(&self) -> String {
        list_text(&self.to_array())
    }

    fn is_finite(&self) -> bool {
        Self::is_finite(*self)
    }
}

impl SettingValue for MaskWeights {
    fn values() -> Values {
        Values::of_form(ValueForm::Numbers(&[9, 25])).restricted("row by row")
    }

    /// Parses 25 weights, or nine, which become the centre of the mask.
    fn parse(text: &str) -> Result<Self, String> {
        parse_list(text, |numbers| {
            let inner = <[f32; 9]>::try_from(numbers).map(centred_in_5x5);
            inner.or_else(|_| Self::try_from(numbers)).ok()
        })
    }

    fn text(&self) -> String {
        list_text(self)
    }

    fn is_finite(&self) -> bool {
        self.iter().all(SettingValue::is_finite)
    }
}

impl SettingValue for Background {
    fn values() -> Values {
        Values { form: Some(ValueForm::Color), ..Values::of_words([Word::plain(Self::Scene.to_string())]) }
    }

    fn parse(text: &str) -> Result<Self, String> {
        text.parse()
    }

    fn text(&self) -> String {
        self.to_string()
    }
}

impl SettingValue for Scale {
    fn values() -> Values {
        Values::of_form(ValueForm::Number(Some(Self::ONE.value() as f32..=Self::FOUR.value() as f32)))
    }

    /// Parses a multiple of 1/10 from 1 to 4.
    fn parse(text: &str) -> Result<Self, String> {
        let number = f32::parse(text)?;
        let scale = Self::from(f64::from(number));
        if scale.value() as f32 == number { Ok(scale) } else { Err(format!("`{text}` is not a scale")) }
    }

    fn text(&self) -> String {
        self.to_string()
    }
}
