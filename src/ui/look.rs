//! From a frame to the picture on the canvas: the shown quantity by its range and colours, and the figures of it.

use std::sync::{Arc, OnceLock};

use super::engine::{Request, Shown, View};
use super::overlays::Layer;
use crate::chain::Frame;
use crate::image::{Image, Rgba8};
use crate::inspect::buffers::Buffers;
use crate::inspect::display::{Display, Kind};
use crate::inspect::measured::{Measured, measure};
use crate::inspect::overlays::watch::Watched;
use crate::inspect::overlays::{Context, Sheet, compose};
use crate::inspect::stages;
use crate::inspect::view::{Range, Value, value};
use crate::measure::region::Region;

/// How a quantity is shown, and which figures of it are wanted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// Range, colour map and channels.
    pub display: Display,
    /// The figures that are wanted, if any are.
    pub measures: Option<Measures>,
    /// What is laid over it, the lowest first.
    pub layers: Vec<Layer>,
    /// Whether lines are left out, as they are drawn between large pixels.
    pub vectors: bool,
}

/// Which figures are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// What histograms run over; all values if nothing is given.
    pub axis: Option<Range>,
    /// A rectangle that has figures of its own.
    pub region: Option<Region>,
}

/// The answer to a [`Look`].
#[derive(Clone, Debug)]
pub struct Looked {
    /// The picture after a stage as it was drawn, where such a picture is shown.
    pub stage: Option<Arc<Image<Rgba8>>>,
    /// The quantity in its colours.
    pub base: Arc<Image<Rgba8>>,
    /// The picture to show.
    pub picture: Arc<Image<Rgba8>>,
    /// Ends of the colour map, or of each channel; none where names are shown.
    pub range: Option<Range>,
    /// What is laid over it, in the order of the layers.
    pub sheets: Vec<Arc<Sheet>>,
    /// The watched drawing of the frame that overlays share, once one needed it.
    watched: Arc<OnceLock<Watched>>,
    /// The figures, if they were wanted.
    pub measured: Option<Arc<Measured>>,
}

/// Answers the look of a request, reusing what was found for the one before of the same frame, if there was one.
pub fn look(request: &Request, frame: &Frame, buffers: Option<&Buffers>, kept: Option<(Request, Looked)>) -> Looked {
    let (watched, sheets) = match &kept {
        Some((_, looked)) => (looked.watched.clone(), looked.sheets.clone()),
        None => Default::default(),
    };
    let same_shown = |(before, _): &(Request, Looked)| before.shown == request.shown;
    let same_colors = kept.as_ref().is_some_and(|k| same_shown(k) && k.0.look.display == request.look.display);
    let kept = kept.filter(same_shown);
    let stage = match request.shown {
        Shown::Stage(stage) => Some(kept.as_ref().and_then(|(_, looked)| looked.stage.clone()).unwrap_or_else(|| {
            Arc::new(stages::picture(&request.scene, &request.camera, &request.recipe, frame, stage))
        })),
        Shown::Buffer(_) => None,
    };
    let display = request.look.display;
    let (base, range) = match kept.as_ref().filter(|_| same_colors) {
        Some((_, looked)) => (looked.base.clone(), looked.range),
        None => colored(&display, request.shown, frame, buffers, stage.as_ref()),
    };
    let same_figures = |(before, _): &&(Request, Looked)| before.look.measures == request.look.measures;
    let measured = match kept.as_ref().filter(same_figures) {
        Some((_, looked)) => looked.measured.clone(),
        None => request.look.measures.map(|wanted| {
            let value = |x: u32, y: u32| value_at(request.shown, frame, buffers, stage.as_deref(), x, y);
            let count = kind(request.shown).channels().len();
            Arc::new(measure(frame.image().size(), count, wanted.axis, wanted.region, value))
        }),
    };
    let still_right = |sheet: &&Arc<Sheet>| same_colors || !sheet.overlay.reads_shown();
    let shown = |x: u32, y: u32| value_at(request.shown, frame, buffers, stage.as_deref(), x, y);
    let context = Context {
        scene: &request.scene,
        recipe: &request.recipe,
        frame,
        is_whole: request.triangle_limit.is_none(),
        watched: &watched,
        shown: &shown,
        range,
    };
    let sheet = |layer: &Layer| {
        let known = sheets.iter().filter(still_right).find(|sheet| sheet.overlay == layer.overlay);
        known.cloned().unwrap_or_else(|| Arc::new(layer.overlay.sheet(&context)))
    };
    let sheets: Vec<Arc<Sheet>> = request.look.layers.iter().map(sheet).collect();
    let picture = composed(&base, &sheets, &request.look);
    Looked { stage, base, picture, range, measured, sheets, watched }
}

/// The picture with all that is laid over it.
fn composed(base: &Arc<Image<Rgba8>>, sheets: &[Arc<Sheet>], look: &Look) -> Arc<Image<Rgba8>> {
    let in_pixels = |sheet: &Sheet| !look.vectors || sheet.lines.is_empty();
    let layers = sheets.iter().zip(&look.layers).map(|(sheet, layer)| (sheet.as_ref(), layer.opacity));
    let layers: Vec<_> = layers.filter(|(sheet, _)| in_pixels(sheet)).collect();
    if layers.is_empty() { base.clone() } else { Arc::new(compose(base, layers)) }
}

/// What is shown, in its colours, and the ends of its range.
fn colored(
    display: &Display,
    shown: Shown,
    frame: &Frame,
    buffers: Option<&Buffers>,
    stage: Option<&Arc<Image<Rgba8>>>,
) -> (Arc<Image<Rgba8>>, Option<Range>) {
    match (shown, stage) {
        (_, Some(stage)) => {
            let range = display.range_of_colors(stage);
            let plain = *display == Display::default();
            (if plain { stage.clone() } else { Arc::new(display.recolored(stage, range)) }, Some(range))
        }
        (Shown::Buffer(buffer), None) => {
            let range = display.range(buffer, frame, buffers);
            (Arc::new(display.picture(buffer, frame, buffers, range)), range)
        }
        (Shown::Stage(_), None) => (Arc::new(frame.image().clone()), None),
    }
}

/// What the values of something shown are.
pub fn kind(shown: Shown) -> Kind {
    match shown {
        Shown::Buffer(buffer) => Kind::of(buffer),
        Shown::Stage(_) => Kind::Colors,
    }
}

fn value_at(
    shown: Shown,
    frame: &Frame,
    buffers: Option<&Buffers>,
    stage: Option<&Image<Rgba8>>,
    x: u32,
    y: u32,
) -> Value {
    match shown {
        Shown::Buffer(buffer) => value(buffer, frame, buffers, x, y),
        Shown::Stage(_) => stage.and_then(|stage| stage.get(x, y)).map_or(Value::Nothing, Value::Color),
    }
}

impl View {
    /// The exact value that is shown at a pixel inside the picture, whatever colours stand for it.
    pub fn value(&self, x: u32, y: u32) -> Value {
        let stage = self.looked.stage.as_deref();
        value_at(self.request.shown, &self.frame, self.buffers.as_deref(), stage, x, y)
    }
}
