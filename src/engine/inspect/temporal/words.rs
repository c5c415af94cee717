//! Contribution of earlier frames as text.

use super::chain::{FrameShare, PastFrames};
use super::clip::{PixelFrame, PixelHistory};
use super::masks::MaskScore;
use crate::pipeline::settings::Choice as _;
use crate::upscale::BlendSpace;

/// Share below which an outcome is not mentioned: it would be printed as 0.0 %.
const LEAST_SHARE: f64 = 0.0005;

impl FrameShare {
    /// Returns what the frame did with the history of its pixels, as sentences; empty if it only blended them.
    pub fn outcome(&self, space: BlendSpace) -> String {
        let mut parts = Vec::new();
        if self.rectified.abs() >= LEAST_SHARE {
            let change = space.components().into_iter().zip(self.rectification);
            let change: Vec<_> = change.map(|(name, change)| format!("{name} {change:+.4}")).collect();
            parts.push(format!("clamped {} ({})", percent(self.rectified), change.join(", ")));
        }
        if self.locked.abs() >= LEAST_SHARE {
            parts.push(format!("locked {}", percent(self.locked)));
        }
        let rejected = self.rejected.iter().filter(|rejected| rejected.share.abs() >= LEAST_SHARE);
        parts.extend(
            rejected.map(|rejected| format!("rejected {}: {}", percent(rejected.share), rejected.reason.help())),
        );
        parts.join("; ")
    }
}

impl PastFrames {
    /// Returns the rest and whether the chain was reproduced, as sentences.
    pub fn remark(&self) -> String {
        let rest = format!("Rest of older and minor contributions: {}.", percent(self.rest));
        let bits = if self.is_reproduced {
            "Recomputing every step gives the bits of the pixel."
        } else {
            "Recomputing the steps does not give the bits of the pixel."
        };
        format!("{rest} {bits}")
    }
}

impl PixelFrame {
    /// Returns the colours of the pixel in this frame, as one line.
    pub fn line(&self) -> String {
        let hex = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
        let history = self.history.map_or_else(|| "no history".to_owned(), hex);
        let (samples, share) = (hex(self.samples), percent(self.share.into()));
        format!("frame {}: samples {samples} × {share}, history {history}, result {}", self.frame, hex(self.result))
    }
}

impl PixelHistory {
    /// Formats the history as text of several lines.
    pub fn describe(&self) -> String {
        let mut lines = Vec::new();
        if let Some(past) = &self.past_frames {
            lines.extend([String::new(), "contribution of every frame, as its share before clamping".to_owned()]);
            lines.extend(past.frames.iter().map(|frame| {
                let ([x, y], share) = (frame.position_px, percent(frame.share));
                let line = format!("  frame {:>4}  {share:>7}  at ({x:.2}, {y:.2})  ", frame.frame);
                (line + &frame.outcome(past.space)).trim_end().to_owned()
            }));
            lines.push(past.remark());
        }
        lines.extend([String::new(), "colours of the pixel in every frame".to_owned()]);
        lines.extend(self.pixel_frames.iter().map(|frame| format!("  {}", frame.line())));
        if !self.masks.is_empty() {
            lines.extend([
                String::new(),
                "history of all pixels of the frame, compared with the disocclusion".to_owned(),
            ]);
            lines.extend(self.masks.iter().map(|score| format!("  {}", score.sentence())));
        }
        lines.join("\n") + "\n"
    }
}

impl MaskScore {
    /// Returns the size of the mask and its agreement with the exact disocclusion, as one sentence.
    pub fn sentence(&self) -> String {
        let fraction = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), percent);
        format!(
            "{}: {} px, precision {}, recall {} of {} disoccluded px",
            self.mask.name(),
            self.marked,
            fraction(self.precision()),
            fraction(self.recall()),
            self.disoccluded
        )
    }
}

/// Formats a fraction as a percentage with one digit.
fn percent(fraction: f64) -> String {
    format!("{:.1} %", fraction * 100.0)
}
