//! Temporal inspection: how earlier frames contribute to a pixel, and which pixels reject their history.
//!
//! A pixel of a temporal upscaler is blended from samples of its frame and from its history, which is filtered between
//! pixels of the frame before, each blended in the same way. [`TemporalSearch`] draws the frames again from frame 0 on
//! and follows these steps back in time. Every step is recomputed with the arithmetic of the upscaler, so that the
//! chain of steps gives the bits of the pixel.
//!
//! Blending and filtering are linear in the colours; rectification is not. A pixel is therefore the sum of the samples
//! of all frames, each times its share, and of the changes that rectification made:
//!
//! ```text
//! pixel = Σ share of frame k−n · its samples + Σ change by the rectification in frame k−n + rest
//! ```
//!
//! Shares are those before rectification: they say how much of a frame the filters transport, not how much of its colour
//! survives.

mod chain;
mod clip;
mod filter;
mod masks;
mod steps;
#[cfg(test)]
mod tests;
mod words;

pub use chain::FrameShare;
pub use chain::PastFrames;
pub use chain::RejectedShare;
pub use clip::ClipView;
pub use clip::HistoryClip;
pub use clip::PixelFrame;
pub use clip::PixelHistory;
pub use clip::TemporalSearch;
pub use masks::HistoryMask;
pub use masks::HistoryMasks;
pub use masks::MaskScore;
