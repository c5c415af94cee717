//! Overlays on the picture: their card, legends, readouts and vector marks.

pub(crate) mod card;
pub(crate) mod legend;
pub(crate) mod marks;
pub(crate) mod readout;
