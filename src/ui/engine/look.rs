//! Computes the picture on the canvas from a frame: applies range, colours and overlays, and computes statistics of the
//! shown quantity.

use std::sync::{Arc, OnceLock};

use super::{Look, RenderedView, Request, Shown};
use crate::chain::Frame;
use crate::image::{Image, Rgba8};
use crate::inspect::buffers::Buffers;
use crate::inspect::display::{Display, ValueKind};
use crate::inspect::intermediate::Captured;
use crate::inspect::measured::{PictureStatistics, measure};
use crate::inspect::overlays::watch::FragmentStats;
use crate::inspect::overlays::{OverlayContext, OverlayLayer, Sheet, compose};
use crate::inspect::stages;
use crate::inspect::view::{Range, Value, value};
use crate::scene::seams::Seams;

/// Picture drawn with the settings of a [`Look`], and the intermediate results from which it was composed.
#[derive(Clone, Debug)]
pub(crate) struct LookResult {
    /// Picture after the shown pipeline stage; `None` unless the shown values come from such a picture.
    pub(crate) stage: Option<Arc<Image<Rgba8>>>,
    /// Picture of the shown quantity without overlays.
    pub(crate) base: Arc<Image<Rgba8>>,
    /// Picture of the shown quantity with overlays.
    pub(crate) picture: Arc<Image<Rgba8>>,
    /// Value range covered by the colour map or by each colour channel; `None` for categorical values.
    pub(crate) range: Option<Range>,
    /// Visible overlays, in the order of the layers.
    pub(crate) sheets: Vec<Arc<Sheet>>,
    /// Whether something that is slow to compute is still missing from the picture: an overlay, or the faults along
    /// open seams.
    pub(crate) is_unfinished: bool,
    /// All overlays computed for the frame, visible or not.
    computed: Vec<Arc<Sheet>>,
    /// Fragment statistics of the frame, shared by all overlays. An instrumented rendering computes them on first use.
    watched: Arc<OnceLock<FragmentStats>>,
    /// Computed statistics; `None` if none were requested.
    pub(crate) measured: Option<Arc<PictureStatistics>>,
}

/// Inputs from which the values of the shown quantity are read.
#[derive(Clone, Copy)]
pub(crate) struct ValueSource<'a> {
    /// Frame whose values are shown.
    pub(crate) frame: &'a Frame,
    /// Captured buffers of the frame; `None` if the shown quantity does not need them.
    pub(crate) buffers: Option<&'a Buffers>,
    /// Intermediate value of every sample; `None` if the shown quantity is not an intermediate value.
    pub(crate) captured: Option<&'a Captured>,
    /// Picture after the shown stage; `None` unless the shown values come from it.
    pub(crate) stage: Option<&'a Image<Rgba8>>,
    /// Open seams of the scene; `None` if they are not yet known or not needed.
    pub(crate) seams: Option<&'a Seams>,
}

impl ValueSource<'_> {
    /// Returns the shown value at a pixel of the full picture.
    fn value(&self, shown: Shown, x: u32, y: u32) -> Value {
        match shown.source() {
            Shown::Buffer(buffer) => value(buffer, self.frame, self.buffers, x, y),
            Shown::Intermediate(_) => self.captured.map_or(Value::Nothing, |captured| captured.value(self.frame, x, y)),
            Shown::Stage(_) => self.stage.and_then(|stage| stage.get(x, y)).map_or(Value::Nothing, Value::Color),
        }
    }

    /// Returns the picture of the shown quantity, and the value range that its colours cover.
    fn colored(&self, shown: Shown, display: &Display) -> (Image<Rgba8>, Option<Range>) {
        if let Shown::Buffer(buffer) = shown.source() {
            let range = display.range(buffer, self.frame, self.buffers);
            return (display.picture(buffer, self.frame, self.buffers, range), range);
        }
        let (size, value) = (self.frame.image().size(), |x: u32, y: u32| self.value(shown, x, y));
        let range = display.range_of(kind(shown), size, || self.captured.and_then(Captured::range), value);
        (display.picture_of(None, size, range, value), range)
    }
}

/// Treatment of overlays that are slow to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SlowOverlays {
    /// Slow overlays are computed now, which delays the response.
    Computed,
    /// Placeholders stand in for slow overlays, so that the frame appears soon.
    Postponed,
}

/// Computes the picture of a request with its overlays and statistics. Reuses valid parts of `kept`, the result of the
/// last request for the same frame.
pub(crate) fn apply_look(
    request: &Request,
    source: ValueSource<'_>,
    kept: Option<(Request, LookResult)>,
    slow: SlowOverlays,
) -> LookResult {
    let frame = source.frame;
    let (watched, mut made) = match &kept {
        Some((_, looked)) => (looked.watched.clone(), looked.computed.clone()),
        None => Default::default(),
    };
    let kept = kept.filter(|(before, _)| before.shown == request.shown);
    let same_colors = kept.as_ref().is_some_and(|(before, _)| before.look.display == request.look.display);
    let stage = match request.shown.source() {
        Shown::Stage(stage) => Some(kept.as_ref().and_then(|(_, looked)| looked.stage.clone()).unwrap_or_else(|| {
            Arc::new(stages::picture(&request.scene, &request.camera, &request.recipe, frame, stage))
        })),
        _ => None,
    };
    let source = ValueSource { stage: stage.as_deref(), ..source };
    let value = |x: u32, y: u32| source.value(request.shown, x, y);
    let (base, range) = match kept.as_ref().filter(|_| same_colors) {
        Some((_, looked)) => (looked.base.clone(), looked.range),
        None => {
            let (base, range) = source.colored(request.shown, &request.look.display);
            (Arc::new(base), range)
        }
    };
    let same_figures = |(before, _): &&(Request, LookResult)| before.look.statistics == request.look.statistics;
    let measured = match kept.as_ref().filter(same_figures) {
        Some((_, looked)) => looked.measured.clone(),
        None => request.look.statistics.map(|wanted| {
            let count = kind(request.shown).channels().len();
            Arc::new(measure(frame.image().size(), count, wanted.axis, wanted.region, value))
        }),
    };
    let context = OverlayContext {
        scene: &request.scene,
        recipe: &request.recipe,
        frame,
        is_whole: request.triangle_limit.is_none(),
        stats_cache: &watched,
        seams: source.seams,
        shown: &value,
        range,
    };
    made.retain(|sheet| same_colors || !sheet.overlay.reads_shown());
    let mut is_unfinished = false;
    let mut sheet = |layer: &OverlayLayer| {
        if let Some(known) = made.iter().find(|sheet| layer.is_of(sheet)) {
            return known.clone();
        }
        let waits_for_seams = layer.overlay.reads_seams() && source.seams.is_none();
        if waits_for_seams || slow == SlowOverlays::Postponed && layer.overlay.is_slow() {
            is_unfinished = true;
            return Arc::new(layer.overlay.pending_sheet(&context));
        }
        made.retain(|sheet| sheet.overlay != layer.overlay);
        made.push(Arc::new(layer.sheet(&context)));
        made[made.len() - 1].clone()
    };
    let sheets: Vec<Arc<Sheet>> = request.look.layers.iter().map(&mut sheet).collect();
    let before = kept.as_ref().filter(|(before, _)| same_colors && before.look.has_same_layers(&request.look));
    let same_sheets = |looked: &LookResult| looked.sheets.iter().zip(&sheets).all(|(a, b)| Arc::ptr_eq(a, b));
    let picture = match before.filter(|(_, looked)| same_sheets(looked)) {
        Some((_, looked)) => looked.picture.clone(),
        None => composed(&base, &sheets, &request.look),
    };
    LookResult { stage, base, picture, range, measured, sheets, is_unfinished, computed: made, watched }
}

/// Returns `base` with all overlays blended over it, except those that are drawn as vectors.
fn composed(base: &Arc<Image<Rgba8>>, sheets: &[Arc<Sheet>], look: &Look) -> Arc<Image<Rgba8>> {
    let in_pixels = |sheet: &Sheet| !look.vectors || sheet.lines.is_empty();
    let layers = sheets.iter().zip(&look.layers).map(|(sheet, layer)| (sheet.as_ref(), layer.opacity));
    let layers: Vec<_> = layers.filter(|(sheet, _)| in_pixels(sheet)).collect();
    if layers.is_empty() { base.clone() } else { Arc::new(compose(base, layers)) }
}

/// Returns what the values of a shown quantity are: colours, barycentric weights, numbers or triangle ids.
pub(crate) fn kind(shown: Shown) -> ValueKind {
    match shown.source() {
        Shown::Buffer(buffer) => ValueKind::of(buffer),
        Shown::Stage(_) => ValueKind::Colors,
        Shown::Intermediate(_) => ValueKind::Numbers,
    }
}

impl RenderedView {
    /// Returns the exact value of the shown quantity at a pixel inside the picture, independent of range and colour
    /// map.
    pub(crate) fn value(&self, x: u32, y: u32) -> Value {
        let (buffers, stage) = (self.buffers.as_deref(), self.look_result.stage.as_deref());
        ValueSource { frame: &self.frame, buffers, captured: self.captured.as_deref(), stage, seams: None }.value(
            self.request.shown,
            x,
            y,
        )
    }
}
