//! What is right, decided in exact arithmetic.
//!
//! Nothing here rounds, and nothing here is shared with the code that it judges: coordinates become integers of any
//! length, weights become fractions of such integers, and each question is answered in the plainest way that is not
//! foolish. Coverage solves the half-planes of a triangle row by row, so it costs rows and not pixels; triangles that
//! reach behind the eye are decided in homogeneous coordinates, without clipping and without a division by w.
//!
//! ```text
//! number    f32 → integer or fraction, rounding to the 1/256 px grid, distances in ulp
//! region    half-planes → spans of pixels; which pixels are too close to call
//! weights   barycentric and perspective-correct weights, depth and attributes at a pixel centre
//! depth     what each depth buffer ideally stores
//! ```

mod clip_space;

mod depth;

mod number;

mod region;

mod weights;

pub use clip_space::ClipTriangle;
pub use depth::{DepthMapping, DepthStorage, exact_depth, ideal_code};
pub use number::{approximate, error, exact, ulps};
pub use region::{Region, Snap};
pub use weights::{ExactSample, ScreenCorner, exact_sample};
