//! Sentence about the blending of a pixel with its history.

use crate::pipeline::settings::Choice as _;
use crate::upscale::{HistoryStep, Rejection};

/// Returns how a pixel is blended with its history, or why the history is rejected.
pub(super) fn verdict(step: &HistoryStep) -> String {
    let past = match &step.past {
        Ok(past) => past,
        Err(Rejection::FirstFrame) => return String::new(),
        Err(rejection) => return format!("No history: {}.", rejection.help()),
    };
    let [x, y] = past.position_px;
    let percent = (1.0 - step.share) * 100.0;
    let rectified = if past.rectified == past.read {
        String::new()
    } else {
        let changes = step
            .space
            .components()
            .into_iter()
            .zip(past.read.iter().zip(past.rectified))
            .map(|(name, (read, now))| format!("{name} {read:.3} → {now:.3}"));
        format!(", rectified by the samples around it ({})", changes.collect::<Vec<_>>().join(", "))
    };
    format!("{percent:.0} % from the history: the previous frame at {x:.2}, {y:.2}{rectified}.")
}
