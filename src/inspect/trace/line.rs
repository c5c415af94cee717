//! One line of a trace: what was computed, by which formula, what came out, and what should have.

use serde::Serialize;

use super::formula::{Evaluated, Formula};
use super::number::Number;
use crate::inspect::intermediate::Intermediate;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// The part of the pipeline that a line belongs to.
    TraceStage {
        Model = "model", "Model", "The corners of the triangle as the mesh holds them.";
        Transform = "transform", "Transform", "One matrix per draw brings corners from model space through world and view to clip space.";
        Clip = "clip", "Clip", "What reaches outside of the view is cut off, before anything is divided by w.";
        Project = "project", "Project", "Divided by w, scaled to pixels, snapped to the grid.";
        Coverage = "coverage", "Coverage", "Three edge values say on which side of each edge the pixel's centre lies.";
        Weights = "weights", "Weights", "From edge values to the shares of the three corners, on the screen and in space.";
        Depth = "depth", "Depth", "The depth of the fragment against what the depth buffer holds.";
        Attributes = "attributes", "Attributes", "What the corners bring along, mixed by the weights.";
        Texture = "texture", "Texture", "Which texels are read, and with which weights.";
        Light = "light", "Light", "How much light the surface gets.";
        Colour = "colour", "Colour", "Surface times light, encoded as bytes, and blended where something is seen through.";
        Resolve = "resolve", "Resolve", "The mean of the samples of the pixel.";
        Upscale = "upscale", "Upscale", "From drawn samples to the pixel of the full picture.";
    }
}

choice! {
    /// Something on a line that is worth stopping at.
    Notable {
        NotFinite = "not-finite", "NaN or infinite", "The result is no finite number.";
        Tie = "tie", "Tie", "A value is exactly on the border: a rule decides, not a number.";
        Cancellation = "cancellation", "Cancellation", "Nearly equal numbers were subtracted: a third of the digits or more are gone, and what was rounded before weighs that much more.";
        DepthEqual = "depth-equal", "Equal depth", "The fragment has exactly the depth that is stored already.";
        Subnormal = "subnormal", "Subnormal", "The result is so small that its type has fewer digits for it.";
    }
}

/// A flag on a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Flag {
    /// What it says.
    pub kind: Notable,
    /// How many leading bits were lost to a cancellation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_bits: Option<u32>,
}

impl Flag {
    /// In a few words.
    pub fn words(self) -> String {
        match self.lost_bits {
            Some(bits) => format!("{} of {bits} bits", self.kind.name()),
            None => self.kind.name().to_owned(),
        }
    }
}

/// What a line arrives at.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Outcome {
    /// A number.
    Number(Number),
    /// A decision.
    Words(String),
}

/// An exact number as text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ExactText {
    /// Its digits; those that are cut off are marked.
    pub decimal: String,
    /// As a fraction, if that is short.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fraction: Option<String>,
}

/// One line.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TraceLine {
    /// Where in the pipeline.
    pub stage: TraceStage,
    /// What it is.
    pub what: String,
    /// How it is computed, in names and signs, or where it comes from.
    pub formula: String,
    /// The formula with the numbers in place of the names; empty for what is read.
    pub numbers: String,
    /// What the pipeline arrived at.
    pub value: Outcome,
    /// The type of the number; empty for decisions.
    pub kind: &'static str,
    /// Its bits; empty for decisions.
    pub bits: String,
    /// What the formula comes to without any rounding, from the very inputs of this line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<ExactText>,
    /// How far the value lies above the exact one, in units of the last place of its type.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rounding_ulp: Option<f64>,
    /// Whether it is the result of one operation that rounds correctly: at most half an ulp.
    pub rounded_once: bool,
    /// The most leading bits that any sum or difference in the formula cancelled.
    #[serde(skip_serializing_if = "is_zero")]
    pub lost_bits: u32,
    /// Whether the pipeline does not compute it: it only helps to read the rest.
    pub aside: bool,
    /// What is worth stopping at.
    pub flags: Vec<Flag>,
    /// The buffer that shows it all over the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buffer: Option<Intermediate>,
}

impl TraceLine {
    /// Whether it has this flag.
    pub fn has(&self, kind: Notable) -> bool {
        self.flags.iter().any(|flag| flag.kind == kind)
    }

    /// Its number, if it is no decision.
    pub fn number(&self) -> Option<Number> {
        match &self.value {
            Outcome::Number(number) => Some(*number),
            Outcome::Words(_) => None,
        }
    }

    /// The rounding in words; empty where none is known.
    pub fn rounding(&self) -> String {
        let Some(ulps) = self.rounding_ulp else { return String::new() };
        let unit = if self.number().is_some_and(Number::is_float) { "ulp" } else { "steps" };
        if ulps == 0.0 {
            return "exact".to_owned();
        }
        let magnitude = ulps.abs();
        let sign = if ulps < 0.0 { '−' } else { '+' };
        if (0.001..1e6).contains(&magnitude) {
            format!("{sign}{magnitude:.3} {unit}")
        } else {
            format!("{sign}{magnitude:.1e} {unit}").replace("e-", "e−")
        }
    }

    /// Its value as text.
    pub fn value_text(&self) -> String {
        match &self.value {
            Outcome::Number(number) => number.to_string(),
            Outcome::Words(words) => words.clone(),
        }
    }
}

/// Writes lines, stage by stage.
#[derive(Debug)]
pub(super) struct Scribe {
    stage: TraceStage,
    lines: Vec<TraceLine>,
}

impl Scribe {
    /// Nothing written yet.
    pub(super) fn new() -> Self {
        Self { stage: TraceStage::Model, lines: Vec::new() }
    }

    /// Goes on to a stage.
    pub(super) fn enter(&mut self, stage: TraceStage) {
        self.stage = stage;
    }

    /// Everything that was written.
    pub(super) fn finish(self) -> Vec<TraceLine> {
        self.lines
    }

    /// A number that is read, not computed; `words` say where from.
    pub(super) fn read(&mut self, what: impl Into<String>, words: impl Into<String>, number: impl Into<Number>) {
        self.number(what.into(), words.into(), number.into());
    }

    /// A number that the pipeline computed, and what it should be.
    pub(super) fn compute(
        &mut self,
        what: impl Into<String>,
        number: impl Into<Number>,
        formula: &Formula,
    ) -> &mut TraceLine {
        let number = number.into();
        let evaluated = formula.evaluate();
        let rounded_once = rounds_once(number, formula);
        let line = self.number(what.into(), formula.words(), number);
        line.numbers = formula.numbers();
        if let Some(Evaluated { value, lost_bits }) = evaluated {
            let (decimal, complete) = value.decimal(EXACT_DIGITS);
            let fraction = if complete { None } else { value.short_fraction() };
            line.exact = Some(ExactText { decimal, fraction });
            line.rounding_ulp = number.rounding_ulp(&value);
            line.rounded_once = rounded_once && line.rounding_ulp.is_some();
            line.lost_bits = lost_bits;
            let worth_telling = number.precision().is_some_and(|bits| lost_bits >= bits / WORTH_TELLING);
            if worth_telling {
                line.flags.push(Flag { kind: Notable::Cancellation, lost_bits: Some(lost_bits) });
            }
        }
        line
    }

    /// What is no part of the pipeline's arithmetic, but helps to read it.
    pub(super) fn aside(
        &mut self,
        what: impl Into<String>,
        number: impl Into<Number>,
        formula: &Formula,
    ) -> &mut TraceLine {
        let line = self.compute(what, number, formula);
        line.aside = true;
        line.rounded_once = false;
        line
    }

    /// A decision, with the numbers that decided.
    pub(super) fn decide(
        &mut self,
        what: impl Into<String>,
        words: impl Into<String>,
        decision: impl Into<String>,
    ) -> &mut TraceLine {
        self.push(what.into(), words.into(), Outcome::Words(decision.into()))
    }

    fn number(&mut self, what: String, words: String, number: Number) -> &mut TraceLine {
        let line = self.push(what, words, Outcome::Number(number));
        (line.kind, line.bits) = (number.kind(), number.bits());
        if number.is_float() && !number.to_f64().is_finite() {
            line.flags.push(Flag { kind: Notable::NotFinite, lost_bits: None });
        }
        if number.is_subnormal() {
            line.flags.push(Flag { kind: Notable::Subnormal, lost_bits: None });
        }
        line
    }

    fn push(&mut self, what: String, formula: String, value: Outcome) -> &mut TraceLine {
        let line = TraceLine {
            stage: self.stage,
            what,
            formula,
            numbers: String::new(),
            value,
            kind: "",
            bits: String::new(),
            exact: None,
            rounding_ulp: None,
            rounded_once: false,
            lost_bits: 0,
            aside: false,
            flags: Vec::new(),
            buffer: None,
        };
        let place = self.lines.len();
        self.lines.push(line);
        &mut self.lines[place]
    }
}

impl TraceLine {
    /// Marks what is exactly on the border.
    pub(super) fn flag(&mut self, kind: Notable, holds: bool) -> &mut Self {
        if holds {
            self.flags.push(Flag { kind, lost_bits: None });
        }
        self
    }

    /// Names the buffer that shows it all over the picture.
    pub(super) fn shown_by(&mut self, buffer: Intermediate) -> &mut Self {
        self.buffer = Some(buffer);
        self
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_zero(bits: &u32) -> bool {
    *bits == 0
}

/// Digits of exact numbers that are written: more than a double has.
const EXACT_DIGITS: u32 = 20;

/// A cancellation is worth telling when one in so many of the digits is lost.
const WORTH_TELLING: u32 = 3;

/// Whether a number is the result of one operation at most on inputs of its own type, or of one conversion.
fn rounds_once(number: Number, formula: &Formula) -> bool {
    match formula.operations() {
        0 => true,
        1 => formula.kinds().iter().all(|kind| *kind == number.kind()),
        _ => false,
    }
}
