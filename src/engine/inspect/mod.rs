//! Inspection of a frame: explanations of why a pixel has its colour.
//!
//! Nothing is recorded while a frame is drawn. The inspector *replays* a pixel: it runs the same stages over the same
//! geometry, with a scissor of one pixel and a recording observer. The displayed values are therefore bit-identical to
//! the values that produced the pixel; a test verifies this for every pixel.

pub mod assertions;

pub mod bad_fragments;

mod blending;

pub mod buffer_file;

pub mod buffers;

pub mod control;

pub(crate) mod depth;

pub mod display;

mod explain;

pub mod fates;

pub mod feeds;

pub mod fields;

pub mod find;

pub mod histogram;

pub mod history;

pub(crate) mod hits;

pub mod intermediate;

pub mod lesson;

pub mod measured;

pub mod mesh_view;

pub(crate) mod normals;

pub mod outline;

pub mod overlays;

pub mod pixel;

pub mod place;

pub mod planes;

pub mod probe;

pub mod project;

pub mod range;

mod recording;

pub mod remedy;

pub mod remedy_search;

mod reprojection;

pub mod scrub;

pub mod selection;

pub mod stages;

pub mod statistics;

pub mod temporal;

pub mod trace;

mod value;

mod verdict;

pub mod vertices;

pub mod view;

pub mod watch;

pub mod what_if;

pub use buffers::Buffer;
pub use buffers::capture;
pub use depth::DepthRecord;
pub use explain::explain;
pub use explain::inspect;
pub use fates::Fates;
pub use history::Survey;
pub use hits::FaultKind;
pub use hits::Hits;
pub use intermediate::Intermediate;
pub use pixel::FragmentOutcome;
pub use pixel::FragmentRecord;
pub use pixel::PixelReport;
pub use place::InspectionState;
pub use remedy::Remedy;
pub use selection::TriangleSelection;
pub use stages::Stage;
pub use trace::Trace;
