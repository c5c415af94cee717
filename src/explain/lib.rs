//! Explanation of another renderer's picture: which known faults turn our picture of a scene into theirs.
//!
//! Input: a picture, and the scene, camera and recipe that it should show. Each [`Fault`] is a change of one of our own
//! inputs or of our finished picture, so that our pipeline can draw what a renderer with this fault draws. The search
//! draws the view with single faults and then with combinations, and compares each drawing with the picture.
//!
//! A fault is named only if drawings with it agree with the picture in many pixels that no drawing without it explains,
//! and hardly any pixel agrees only without it. What remains is reported as unexplained.

mod agreement;
mod buffer_files;
mod buffers;
mod candidate;
mod cause;
mod depth_map;
mod explanation;
mod fault;
mod faults;
mod geometry;
mod polygons;
mod query;
mod rest;
mod search;
mod setup;
mod terminator;
mod text;
mod verification;
mod window;

pub use agreement::TOLERANCE;
pub use buffer_files::{UnusableDepths, depths, ids};
pub use buffers::{DepthReport, IdLevel, IdReport, TheirBuffers};
pub use cause::{Cause, Tally};
pub use explanation::{Confidence, ExplainError, Explanation, explain, explain_with};
pub use fault::{Fault, Kind};
pub use faults::{ALL, by_id};
pub use query::Query;
pub use rest::Rest;
pub use setup::Setup;

#[cfg(test)]
mod tests;
