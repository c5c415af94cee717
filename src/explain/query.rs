//! Question of an explanation: our inputs, and the pictures of the other renderer.

use rasterscope_engine::image::{Image, Rgba8};

use crate::buffers::TheirBuffers;
use crate::setup::Setup;

/// Question: which faults turn our drawing into another renderer's picture?
#[derive(Clone, Debug)]
pub struct Query {
    /// What the picture should show: our inputs without faults.
    pub correct: Setup,
    /// The other renderer's picture, of the size of the setup.
    pub theirs: Image<Rgba8>,
    /// Ids of faults that are not considered.
    pub without: Vec<String>,
}

/// All pictures of the other renderer.
#[derive(Clone, Copy)]
pub(crate) struct Evidence<'a> {
    pub(crate) query: &'a Query,
    pub(crate) buffers: &'a TheirBuffers,
}
