//! Reference results, computed in exact arithmetic.
//!
//! The arithmetic does not round and shares no code with the engine under test. Coordinates become integers of
//! arbitrary length, weights become fractions of such integers, and every result is computed in the simplest practical
//! way. Coverage intersects the half-planes of a triangle row by row, so its cost depends on rows, not pixels.
//! Triangles that reach behind the eye are solved in homogeneous coordinates, without clipping and without division by
//! w.
//!
//! ```text
//! number    f32 → integer or fraction, rounding to the 1/256 px grid, errors in ulp
//! region    half-planes → spans of pixels; borderline pixels
//! weights   barycentric and perspective-correct weights, depth and attributes at a pixel centre
//! depth     ideal contents of each depth buffer
//! ```

mod clip_space;

mod depth;

mod number;

mod region;

mod weights;

pub(crate) use clip_space::ClipTriangle;
pub(crate) use depth::DepthMapping;
pub(crate) use depth::DepthStorage;
pub(crate) use depth::exact_depth;
pub(crate) use depth::ideal_code;
#[cfg(test)]
pub(crate) use number::approximate;
pub(crate) use number::error;
#[cfg(test)]
pub(crate) use number::exact;
pub(crate) use number::ulps;
pub(crate) use region::ExactRegion;
pub(crate) use region::Snap;
pub(crate) use weights::ExactSample;
pub(crate) use weights::ScreenCorner;
pub(crate) use weights::exact_sample;
