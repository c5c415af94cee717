//! From a frame to the picture on the canvas: the shown quantity by its range and colours, and the figures of it.

use std::sync::Arc;

use super::engine::{Request, Shown, View};
use crate::chain::Frame;
use crate::image::{Image, Rgba8};
use crate::inspect::buffers::Buffers;
use crate::inspect::display::{Display, Kind};
use crate::inspect::measured::{Measured, measure};
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
    /// The figures, if they were wanted.
    pub measured: Option<Arc<Measured>>,
}

/// Answers the look of a request, reusing what was found for the one before of the same frame, if there was one.
pub fn look(request: &Request, frame: &Frame, buffers: Option<&Buffers>, kept: Option<(Request, Looked)>) -> Looked {
    let kept = kept.filter(|(before, _)| before.shown == request.shown);
    let stage = match request.shown {
        Shown::Stage(stage) => Some(kept.as_ref().and_then(|(_, looked)| looked.stage.clone()).unwrap_or_else(|| {
            Arc::new(stages::picture(&request.scene, &request.camera, &request.recipe, frame, stage))
        })),
        Shown::Buffer(_) => None,
    };
    let display = request.look.display;
    let same_display = |(before, _): &&(Request, Looked)| before.look.display == display;
    let (base, range) = match kept.as_ref().filter(same_display) {
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
    Looked { stage, picture: base.clone(), base, range, measured }
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
