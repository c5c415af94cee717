//! Inspection of a frame: explanations of why a pixel has its colour.
//!
//! Nothing is recorded while a frame is drawn. The inspector *replays* a pixel: it runs the same stages over the same
//! geometry, with a scissor of one pixel and a recording observer. The displayed values are therefore bit-identical to
//! the values that produced the pixel; a test verifies this for every pixel.

pub mod assertions;

pub(crate) mod bad_fragments;

mod blending;

pub mod buffers;

pub(crate) mod depth;

pub(crate) mod display;

pub mod fates;

pub(crate) mod feeds;

pub(crate) mod fields;

pub(crate) mod find;

pub(crate) mod histogram;

pub(crate) mod history;

pub(crate) mod hits;

pub mod intermediate;

pub(crate) mod lesson;

pub(crate) mod measured;

pub(crate) mod mesh_view;

pub(crate) mod normals;

pub mod outline;

pub mod overlays;

pub(crate) mod pixel;

pub(crate) mod place;

pub(crate) mod planes;

pub(crate) mod probe;

pub(crate) mod range;

pub(crate) mod scrub;

pub(crate) mod selection;

pub(crate) mod stages;

pub(crate) mod statistics;

pub mod trace;

mod verdict;

pub(crate) mod vertices;

pub(crate) mod view;

pub(crate) mod watch;

pub(crate) mod what_if;

pub use buffers::Buffer;
pub use buffers::capture;
pub(crate) use depth::DepthRecord;
pub(crate) use fates::Fates;
pub(crate) use history::Survey;
pub(crate) use history::explain;
pub(crate) use hits::FaultKind;
pub(crate) use hits::Hits;
pub use intermediate::Intermediate;
pub use pixel::FragmentOutcome;
pub(crate) use pixel::FragmentRecord;
pub(crate) use pixel::PixelReport;
pub use pixel::inspect;
pub(crate) use place::InspectionState;
pub(crate) use selection::TriangleSelection;
pub use stages::Stage;
pub use trace::Trace;
