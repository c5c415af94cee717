//! Lines of a trace: each has a quantity, its formula, the pipeline's value, and the exact value.

use serde::Serialize;

use super::formula::{Evaluated, Formula};
use super::number::Number;
use crate::inspect::intermediate::Intermediate;
use crate::pipeline::settings::{Choice, choice};

choice! {
    /// Pipeline stage to which a trace line belongs.
    pub TraceStage {
        Model = "model", "Model", "The corners of the triangle as stored in the mesh.";
        Transform = "transform", "Transform", "One matrix per draw transforms corners from model space through world and view to clip space.";
        Clip = "clip", "Clip", "Parts of the triangle outside the view are clipped away before the division by w.";
        Project = "project", "Project", "The corners are divided by w, scaled to pixels and snapped to the grid.";
        Coverage = "coverage", "Coverage", "Three edge values decide on which side of each edge the pixel's centre lies.";
        Weights = "weights", "Weights", "The weights of the three corners, from the edge values: in screen space and for attributes.";
        Depth = "depth", "Depth", "The depth of the fragment, compared with the stored depth.";
        Attributes = "attributes", "Attributes", "The attributes of the corners, interpolated by the weights.";
        Texture = "texture", "Texture", "The texels that are read, and their weights.";
        Light = "light", "Light", "The light that the surface receives.";
        Colour = "colour", "Colour", "Surface colour times light, encoded as bytes, and blended for transparency.";
        Motion = "motion", "Motion", "The triangle in this frame and in the preceding one, and the motion vector of the pixel.";
        Resolve = "resolve", "Resolve", "The mean of the samples of the pixel.";
        Upscale = "upscale", "Upscale", "The pixel of the full picture, reconstructed from drawn samples.";
    }
}

choice! {
    /// Notable property of a trace line, such as a tie.
    pub Notable {
        NotFinite = "not-finite", "NaN or infinite", "The result is NaN or infinite.";
        Tie = "tie", "Tie", "A value lies exactly on a boundary, so a rule decides.";
        Cancellation = "cancellation", "Cancellation", "Nearly equal numbers were subtracted: at least a third of the digits are lost, and earlier rounding errors grow accordingly.";
        DepthEqual = "depth-equal", "Equal depth", "The fragment has exactly the stored depth.";
        Subnormal = "subnormal", "Subnormal", "The result is so small that it has fewer significant digits than its type normally holds.";
    }
}

/// Notable property of a trace line, with details.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Flag {
    /// Kind of property, such as a tie or cancellation.
    pub kind: Notable,
    /// Number of leading bits lost to cancellation; `None` for other kinds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lost_bits: Option<u32>,
}

impl Flag {
    /// Returns a short description of the flag, such as "Cancellation of 12 bits".
    pub fn words(self) -> String {
        match self.lost_bits {
            Some(bits) => format!("{} of {bits} bits", self.kind.name()),
            None => self.kind.name().to_owned(),
        }
    }
}

/// Result on a trace line: a number or a decision.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum LineResult {
    /// Number that the pipeline computed or read.
    Number(Number),
    /// Decision that the pipeline made, as text.
    Words(String),
}

/// Exact number as text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ExactText {
    /// Decimal digits; truncation is marked with “…”.
    pub decimal: String,
    /// The number as a fraction, such as "1/3"; `None` if the decimal is complete or the fraction is long.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fraction: Option<String>,
}

/// One line of a trace: a value of the pipeline, its formula, and its exact result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TraceLine {
    /// Pipeline stage of the line.
    pub stage: TraceStage,
    /// Name of the computed quantity.
    pub what: String,
    /// Formula with names and operators, or the source of the line's value.
    pub formula: String,
    /// Formula with numbers instead of names; empty for values that are read.
    pub numbers: String,
    /// Number or decision that the pipeline computed.
    pub value: LineResult,
    /// Type of the number, such as "f32"; empty for decisions.
    pub kind: &'static str,
    /// Bit pattern of the number in hexadecimal; empty for decisions.
    pub bits: String,
    /// Exact result of the formula for the inputs of this line; `None` without a formula or for non-finite inputs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<ExactText>,
    /// Rounding error: value minus exact value, in units in the last place of the value's type.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rounding_ulp: Option<f64>,
    /// Whether the value results from at most one correctly rounded operation, with an error of at most half an ulp.
    pub(crate) rounded_once: bool,
    /// Maximum number of leading bits cancelled by any sum or difference in the formula.
    #[serde(skip_serializing_if = "is_zero")]
    pub(crate) lost_bits: u32,
    /// Whether the line is only explanatory: the pipeline does not compute its value.
    pub aside: bool,
    /// Notable properties of the line.
    pub flags: Vec<Flag>,
    /// Intermediate value that corresponds to the line and can be shown for the whole picture, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub buffer: Option<Intermediate>,
}

impl TraceLine {
    /// Whether the line has a flag of this kind.
    pub(crate) fn has(&self, kind: Notable) -> bool {
        self.flags.iter().any(|flag| flag.kind == kind)
    }

    /// Returns the number on the line; `None` for a decision.
    pub fn number(&self) -> Option<Number> {
        match &self.value {
            LineResult::Number(number) => Some(*number),
            LineResult::Words(_) => None,
        }
    }

    /// Returns the rounding error as text; empty if unknown.
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

    /// Returns the number or the decision as text.
    pub fn value_text(&self) -> String {
        match &self.value {
            LineResult::Number(number) => number.to_string(),
            LineResult::Words(words) => words.clone(),
        }
    }
}

/// Recorder of trace lines, stage by stage.
#[derive(Debug)]
pub(super) struct TraceRecorder {
    stage: TraceStage,
    lines: Vec<TraceLine>,
}

impl TraceRecorder {
    /// Creates a recorder without lines.
    pub(super) fn new() -> Self {
        Self { stage: TraceStage::Model, lines: Vec::new() }
    }

    /// Sets the stage of the following lines.
    pub(super) fn enter(&mut self, stage: TraceStage) {
        self.stage = stage;
    }

    /// Returns all recorded lines.
    pub(super) fn finish(self) -> Vec<TraceLine> {
        self.lines
    }

    /// Records a number that is read, not computed; `words` names its source.
    pub(super) fn read(&mut self, what: impl Into<String>, words: impl Into<String>, number: impl Into<Number>) {
        self.number(what.into(), words.into(), number.into());
    }

    /// Records a number that the pipeline computed, with the formula for its exact value.
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
            let worth_telling = number.precision().is_some_and(|bits| lost_bits >= bits / CANCELLATION_DIVISOR);
            if worth_telling {
                line.flags.push(Flag { kind: Notable::Cancellation, lost_bits: Some(lost_bits) });
            }
        }
        line
    }

    /// Records a number that the pipeline does not compute, but that explains its arithmetic.
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

    /// Records a decision of the pipeline; `words` states the reason.
    pub(super) fn decide(
        &mut self,
        what: impl Into<String>,
        words: impl Into<String>,
        decision: impl Into<String>,
    ) -> &mut TraceLine {
        self.push(what.into(), words.into(), LineResult::Words(decision.into()))
    }

    fn number(&mut self, what: String, words: String, number: Number) -> &mut TraceLine {
        let line = self.push(what, words, LineResult::Number(number));
        (line.kind, line.bits) = (number.kind(), number.bits());
        if number.is_float() && !number.to_f64().is_finite() {
            line.flags.push(Flag { kind: Notable::NotFinite, lost_bits: None });
        }
        if number.is_subnormal() {
            line.flags.push(Flag { kind: Notable::Subnormal, lost_bits: None });
        }
        line
    }

    fn push(&mut self, what: String, formula: String, value: LineResult) -> &mut TraceLine {
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
    /// Flags the line as `kind` if `holds` is true.
    pub(super) fn flag(&mut self, kind: Notable, holds: bool) -> &mut Self {
        if holds {
            self.flags.push(Flag { kind, lost_bits: None });
        }
        self
    }

    /// Links the line to the corresponding intermediate value, which can be shown for the whole picture.
    pub(super) fn shown_by(&mut self, buffer: Intermediate) -> &mut Self {
        self.buffer = Some(buffer);
        self
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde hands out references")]
fn is_zero(bits: &u32) -> bool {
    *bits == 0
}

/// Number of significant decimal digits of exact results, more than the 17 that identify an f64.
const EXACT_DIGITS: u32 = 20;

/// Cancellation is flagged if the number of lost leading bits is at least the type's precision in bits divided by this.
const CANCELLATION_DIVISOR: u32 = 3;

/// Whether a number results from at most one operation on inputs of its own type, or from one conversion.
fn rounds_once(number: Number, formula: &Formula) -> bool {
    match formula.operations() {
        0 => true,
        1 => formula.kinds().iter().all(|kind| *kind == number.kind()),
        _ => false,
    }
}
