//! From a frame to the picture on the canvas: the shown quantity by its range and colours, and the figures of it.

use std::sync::{Arc, OnceLock};

use super::engine::{Request, Shown, View};
use super::overlays::Layer;
use crate::chain::Frame;
use crate::image::{Image, Rgba8};
use crate::inspect::buffers::Buffers;
use crate::inspect::display::{Display, Kind};
use crate::inspect::intermediate::Captured;
use crate::inspect::measured::{Measured, measure};
use crate::inspect::overlays::watch::Watched;
use crate::inspect::overlays::{Context, Sheet, compose};
use crate::inspect::stages;
use crate::inspect::view::{Range, Value, value};
use crate::measure::region::Region;
use crate::scene::seams::Seams;

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

impl Look {
    /// Whether the same is laid over the picture.
    fn has_same_layers(&self, other: &Self) -> bool {
        (&self.layers, self.vectors) == (&other.layers, other.vectors)
    }
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
    /// Whether some of it stands for overlays that are yet to be made, as they take long.
    pub is_unfinished: bool,
    /// All sheets that were made for the frame, laid over the picture or not.
    made: Vec<Arc<Sheet>>,
    /// The watched drawing of the frame that overlays share, once one needed it.
    watched: Arc<OnceLock<Watched>>,
    /// The figures, if they were wanted.
    pub measured: Option<Arc<Measured>>,
}

/// Everything that values come from.
#[derive(Clone, Copy)]
pub struct Source<'a> {
    /// The frame.
    pub frame: &'a Frame,
    /// Quantities of the frame, if a buffer that needs them is shown.
    pub buffers: Option<&'a Buffers>,
    /// The number of every sample that is shown, if one is.
    pub captured: Option<&'a Captured>,
    /// The picture after a stage, if such a picture is shown.
    pub stage: Option<&'a Image<Rgba8>>,
    /// Open seams of the scene, if something reads them and they are known.
    pub seams: Option<&'a Seams>,
}

impl Source<'_> {
    /// What is shown at a pixel of the full picture.
    fn value(&self, shown: Shown, x: u32, y: u32) -> Value {
        match shown {
            Shown::Buffer(buffer) => value(buffer, self.frame, self.buffers, x, y),
            Shown::Intermediate(_) => self.captured.map_or(Value::Nothing, |captured| captured.value(self.frame, x, y)),
            Shown::Stage(_) => self.stage.and_then(|stage| stage.get(x, y)).map_or(Value::Nothing, Value::Color),
        }
    }

    /// What is shown, in its colours, and the ends of its range.
    fn colored(&self, shown: Shown, display: &Display) -> (Image<Rgba8>, Option<Range>) {
        if let Shown::Buffer(buffer) = shown {
            let range = display.range(buffer, self.frame, self.buffers);
            return (display.picture(buffer, self.frame, self.buffers, range), range);
        }
        let (size, value) = (self.frame.image().size(), |x: u32, y: u32| self.value(shown, x, y));
        let range = display.range_of(kind(shown), size, || self.captured.and_then(Captured::range), value);
        (display.picture_of(None, size, range, value), range)
    }
}

/// Whether overlays that take long are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slow {
    /// They are.
    Made,
    /// Others stand for them, so that the frame is seen soon.
    Postponed,
}

/// Answers the look of a request, reusing what was found for the one before of the same frame, if there was one.
pub fn look(request: &Request, source: Source<'_>, kept: Option<(Request, Looked)>, slow: Slow) -> Looked {
    let frame = source.frame;
    let (watched, mut made) = match &kept {
        Some((_, looked)) => (looked.watched.clone(), looked.made.clone()),
        None => Default::default(),
    };
    let kept = kept.filter(|(before, _)| before.shown == request.shown);
    let same_colors = kept.as_ref().is_some_and(|(before, _)| before.look.display == request.look.display);
    let stage = match request.shown {
        Shown::Stage(stage) => Some(kept.as_ref().and_then(|(_, looked)| looked.stage.clone()).unwrap_or_else(|| {
            Arc::new(stages::picture(&request.scene, &request.camera, &request.recipe, frame, stage))
        })),
        _ => None,
    };
    let source = Source { stage: stage.as_deref(), ..source };
    let value = |x: u32, y: u32| source.value(request.shown, x, y);
    let (base, range) = match kept.as_ref().filter(|_| same_colors) {
        Some((_, looked)) => (looked.base.clone(), looked.range),
        None => {
            let (base, range) = source.colored(request.shown, &request.look.display);
            (Arc::new(base), range)
        }
    };
    let same_figures = |(before, _): &&(Request, Looked)| before.look.measures == request.look.measures;
    let measured = match kept.as_ref().filter(same_figures) {
        Some((_, looked)) => looked.measured.clone(),
        None => request.look.measures.map(|wanted| {
            let count = kind(request.shown).channels().len();
            Arc::new(measure(frame.image().size(), count, wanted.axis, wanted.region, value))
        }),
    };
    let context = Context {
        scene: &request.scene,
        recipe: &request.recipe,
        frame,
        is_whole: request.triangle_limit.is_none(),
        watched: &watched,
        seams: source.seams,
        shown: &value,
        range,
    };
    made.retain(|sheet| same_colors || !sheet.overlay.reads_shown());
    let mut is_unfinished = false;
    let mut sheet = |layer: &Layer| {
        if let Some(known) = made.iter().find(|sheet| layer.is_of(sheet)) {
            return known.clone();
        }
        let waits_for_seams = layer.overlay.reads_seams() && source.seams.is_none();
        if waits_for_seams || slow == Slow::Postponed && layer.overlay.is_slow() {
            is_unfinished = true;
            return Arc::new(layer.overlay.unmade(&context));
        }
        made.retain(|sheet| sheet.overlay != layer.overlay);
        made.push(Arc::new(layer.sheet(&context)));
        made[made.len() - 1].clone()
    };
    let sheets: Vec<Arc<Sheet>> = request.look.layers.iter().map(&mut sheet).collect();
    let before = kept.as_ref().filter(|(before, _)| same_colors && before.look.has_same_layers(&request.look));
    let same_sheets = |looked: &Looked| looked.sheets.iter().zip(&sheets).all(|(a, b)| Arc::ptr_eq(a, b));
    let picture = match before.filter(|(_, looked)| same_sheets(looked)) {
        Some((_, looked)) => looked.picture.clone(),
        None => composed(&base, &sheets, &request.look),
    };
    Looked { stage, base, picture, range, measured, sheets, is_unfinished, made, watched }
}

/// The picture with all that is laid over it.
fn composed(base: &Arc<Image<Rgba8>>, sheets: &[Arc<Sheet>], look: &Look) -> Arc<Image<Rgba8>> {
    let in_pixels = |sheet: &Sheet| !look.vectors || sheet.lines.is_empty();
    let layers = sheets.iter().zip(&look.layers).map(|(sheet, layer)| (sheet.as_ref(), layer.opacity));
    let layers: Vec<_> = layers.filter(|(sheet, _)| in_pixels(sheet)).collect();
    if layers.is_empty() { base.clone() } else { Arc::new(compose(base, layers)) }
}

/// What the values of something shown are.
pub fn kind(shown: Shown) -> Kind {
    match shown {
        Shown::Buffer(buffer) => Kind::of(buffer),
        Shown::Stage(_) => Kind::Colors,
        Shown::Intermediate(_) => Kind::Numbers,
    }
}

impl View {
    /// The exact value that is shown at a pixel inside the picture, whatever colours stand for it.
    pub fn value(&self, x: u32, y: u32) -> Value {
        let (buffers, stage) = (self.buffers.as_deref(), self.looked.stage.as_deref());
        Source { frame: &self.frame, buffers, captured: self.captured.as_deref(), stage, seams: None }.value(
            self.request.shown,
            x,
            y,
        )
    }
}
