//! Explanations in words, and as JSON.

use std::fmt::{self, Display, Formatter};

use serde::{Serialize, Serializer};

use crate::agreement::TOLERANCE;
use crate::buffers::{DepthReport, IdLevel, IdReport};
use crate::cause::{Cause, Tally};
use crate::explanation::{Confidence, Explanation};
use crate::fault::Kind;
use crate::rest::Rest;

/// Largest number of objects that are listed as unexplained.
const MOST_OBJECTS: usize = 5;

impl Display for Explanation {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.summary())?;
        for (number, cause) in (1..).zip(&self.causes) {
            writeln!(f, "{number}. {cause}")?;
        }
        let share = |count: u64| format!("{count} of {} px ({:.2} %)", self.pixels, self.percent(count));
        writeln!(f, "differing by more than {TOLERANCE} codes, before: {}", share(self.differing_before))?;
        if !self.causes.is_empty() {
            writeln!(f, "differing after: {}", share(self.differing_after))?;
        }
        if let Some(depth) = &self.depth {
            writeln!(f, "{depth}")?;
        }
        if let Some(ids) = &self.ids {
            writeln!(f, "{ids}")?;
        }
        for rest in self.rest.iter().take(MOST_OBJECTS) {
            writeln!(f, "unexplained: {rest}")?;
        }
        let others: u64 = self.rest.iter().skip(MOST_OBJECTS).map(|rest| rest.pixels).sum();
        if others > 0 {
            writeln!(f, "unexplained: {others} px on {} other objects", self.rest.len() - MOST_OBJECTS)?;
        }
        Ok(())
    }
}

impl Explanation {
    /// Returns the answer in one sentence.
    pub fn summary(&self) -> String {
        match self.confidence {
            Confidence::Agrees if self.have_other_buffers() => {
                "The colours agree with ours, but the depths or ids do not.".to_owned()
            }
            Confidence::Agrees if self.differing_before == 0 => "The picture agrees with ours.".to_owned(),
            Confidence::Agrees => {
                format!("The picture agrees with ours, except for {} scattered px.", self.differing_before)
            }
            Confidence::Complete if self.causes.iter().all(|cause| cause.fault.kind == Kind::Input) => {
                "The picture agrees with ours, except that it was drawn from other inputs:".to_owned()
            }
            Confidence::Complete => format!("{} the picture:", self.count()),
            Confidence::Partial if self.causes.iter().all(|cause| cause.fault.kind == Kind::Input) => {
                "No known fault explains the picture, which was also drawn from other inputs:".to_owned()
            }
            Confidence::Partial => {
                format!("{} a part of the picture; nothing known explains the rest:", self.count())
            }
            Confidence::Unknown => "No known fault explains the picture.".to_owned(),
        }
    }

    /// Whether more than 1 % of the depths or ids differ.
    fn have_other_buffers(&self) -> bool {
        let depths = self.depth.as_ref().map_or(0, |depth| depth.differing_after);
        let ids = self.ids.as_ref().map_or(0, |ids| ids.differing_after);
        100 * depths.max(ids) > self.pixels
    }

    fn count(&self) -> String {
        match self.causes.len() {
            1 => "One difference explains".to_owned(),
            many => format!("{many} differences together explain"),
        }
    }

    fn percent(&self, count: u64) -> f64 {
        count as f64 * 100.0 / self.pixels.max(1) as f64
    }
}

impl Display for Cause {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let kind = match self.fault.kind {
            Kind::Error => "",
            Kind::Convention => " (another convention, not an error)",
            Kind::Input => " (another input, not an error in drawing)",
        };
        let detail = self.detail.as_ref().map(|detail| format!(", {detail}")).unwrap_or_default();
        write!(f, "{}{detail}{kind}: {} px agree only with it", self.fault.title(), self.explained)?;
        if self.spoiled > 0 {
            write!(f, ", {} px only without it", self.spoiled)?;
        }
        for (name, tally) in [("depth", self.depth), ("id", self.ids)] {
            if tally.explained > 0 {
                write!(f, ", {} px agree in {name} only with it", tally.explained)?;
            }
        }
        for other in &self.alternatives {
            write!(f, "; here the same as: {}", other.name)?;
        }
        Ok(())
    }
}

impl Display for DepthReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mapping = self.mapping.as_deref().unwrap_or("no known mapping fits");
        write!(f, "depths: {mapping}")?;
        if let Some(bits) = self.bits {
            write!(f, ", in {bits} bits")?;
        }
        write!(f, "; {} px differ before, {} px after", self.differing_before, self.differing_after)
    }
}

impl Display for IdReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let level = match self.level {
            IdLevel::Objects => "objects",
            IdLevel::Triangles => "triangles",
        };
        write!(f, "ids of {level}: {} px differ before, {} px after", self.differing_before, self.differing_after)
    }
}

impl Display for Rest {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let object = self.object.as_deref().map_or_else(|| "the background".to_owned(), |name| format!("“{name}”"));
        write!(f, "{} px on {object}, {} of them at edges", self.pixels, self.at_edges)?;
        if self.shades > 0 {
            let why = if self.object.is_some() { " (light or normals)" } else { "" };
            write!(f, ", {} only lighter or darker than ours{why}", self.shades)?;
        }
        Ok(())
    }
}

/// A cause in JSON.
#[derive(Serialize)]
struct CauseRecord<'a> {
    fault: &'a str,
    name: &'a str,
    kind: Kind,
    detail: Option<&'a str>,
    explained_px: u64,
    exact_px: u64,
    spoiled_px: u64,
    depth: Tally,
    ids: Tally,
    alternatives: Vec<&'a str>,
}

impl Serialize for Cause {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let record = CauseRecord {
            fault: self.fault.id,
            name: self.fault.name,
            kind: self.fault.kind,
            detail: self.detail.as_deref(),
            explained_px: self.explained,
            exact_px: self.exact,
            spoiled_px: self.spoiled,
            depth: self.depth,
            ids: self.ids,
            alternatives: self.alternatives.iter().map(|fault| fault.id).collect(),
        };
        record.serialize(serializer)
    }
}
