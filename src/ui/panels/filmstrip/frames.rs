//! Frames of the filmstrip as data: picture, frame time and error of each method, in the chosen order.

use std::sync::Arc;

use crate::image::{Image, Rgba8};
use crate::ui::format;
use crate::ui::session::Session;
use crate::ui::session::compare::compute::TileResult;
use crate::ui::session::timings::RowOrder;
use crate::upscale::Upscaling;

/// One frame of the filmstrip.
#[derive(Clone, Debug)]
pub(super) struct StripFrame {
    /// Upscaler with its options.
    pub(super) upscaling: Upscaling,
    /// Complete picture, of which the strip shows a detail.
    pub(super) picture: Arc<Image<Rgba8>>,
    /// Median frame time in milliseconds; `None` unless all upscalers were measured with this view.
    pub(super) ms: Option<f64>,
    /// FLIP error against the reference of the comparison; `None` before it is measured.
    pub(super) flip: Option<f64>,
}

impl StripFrame {
    fn new(tile: &TileResult, session: &Session) -> Self {
        let upscaling = tile.recipe.upscaler;
        let figures = tile.measured.as_ref().and_then(|measured| measured.figures);
        Self {
            upscaling,
            picture: tile.picture.clone(),
            ms: session.features.timings.median_ms(&session.request(), upscaling),
            flip: figures.map(|figures| figures.flip),
        }
    }

    /// Returns frame time and error as text, such as “1.62 ms · FLIP 0.0731”.
    pub(super) fn figures(&self) -> String {
        let ms = self.ms.map(format::ms);
        let flip = self.flip.map(|flip| format!("FLIP {}", format::fixed(flip, 4)));
        let known: Vec<_> = ms.into_iter().chain(flip).collect();
        if known.is_empty() { "measuring…".to_owned() } else { known.join(" · ") }
    }
}

/// Returns the frames drawn so far. Frames without the figure they are sorted by come last; equal ones have the order
/// of the menus.
pub(super) fn collect(session: &Session) -> Vec<StripFrame> {
    let tiles = session.features.filmstrip.drawn.iter().flat_map(|drawn| &drawn.tiles);
    let mut frames: Vec<_> = tiles.map(|tile| StripFrame::new(tile, session)).collect();
    let key = |frame: &StripFrame| match session.features.filmstrip.order {
        RowOrder::Time => frame.ms.unwrap_or(f64::INFINITY),
        RowOrder::Error => frame.flip.unwrap_or(f64::INFINITY),
        RowOrder::Method => 0.0,
    };
    frames.sort_by(|a, b| key(a).total_cmp(&key(b)));
    frames
}
