//! The observer that counts fragments by fate.

use super::{FragmentCounts, FragmentFate};
use crate::chain::Recipe;
use crate::image::{Image, Rgba8};
use crate::pipeline::Geometry;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::{DepthOutcome, Observer};
use crate::pipeline::raster::RasterSample;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::shade::Shader;
use crate::scene::{Scene, Transparency, TriangleId};

/// Sentinel index that ends the list of layers of a sample.
const NO_LAYER: u32 = u32::MAX;

/// A written fragment over which later fragments were blended.
#[derive(Debug)]
struct WrittenFragment {
    triangle: TriangleId,
    /// Index of the next layer below, or [`NO_LAYER`].
    below: u32,
}

/// Observer that counts fragments by triangle and fate, and tracks the top triangle of every sample, while a frame is
/// drawn.
pub(super) struct FateTally<'a> {
    shaders: Vec<Shader<'a>>,
    /// Fragment counts of each triangle of the scene. The topmost fragments are not counted until
    /// [`FateTally::finish`].
    pub(super) fragments: Vec<FragmentCounts>,
    /// Number of fragments that the rasterizer generated, counted independently of their fates.
    pub(super) generated: u64,
    /// Triangle written last at each sample, or [`TriangleId::NONE`].
    pub(super) top_triangle: Image<TriangleId>,
    /// Index of the first layer below the top triangle of each sample, or [`NO_LAYER`].
    below: Image<u32>,
    layers: Vec<WrittenFragment>,
}

impl<'a> FateTally<'a> {
    /// Creates an empty tally for a packed framebuffer of this size, in samples.
    pub(super) fn new(scene: &'a Scene, recipe: &'a Recipe, geometry: &Geometry, (width, height): (u32, u32)) -> Self {
        let shaders = scene.instances.iter().zip(&geometry.plans);
        Self {
            shaders: shaders.map(|(i, plan)| Shader::new(&recipe.pipeline, &scene.library, i, plan)).collect(),
            fragments: vec![FragmentCounts::default(); scene.triangle_count()],
            generated: 0,
            top_triangle: Image::filled(width, height, TriangleId::NONE),
            below: Image::filled(width, height, NO_LAYER),
            layers: Vec::new(),
        }
    }

    /// Counts the fragments that are visible once all triangles are drawn, including those visible through blended
    /// fragments.
    pub(super) fn finish(&mut self) {
        for place in 0..self.top_triangle.pixels().len() {
            let top = self.top_triangle.pixels()[place];
            if top != TriangleId::NONE {
                self.count_fate(top, FragmentFate::Visible);
                self.count_layers(place, FragmentFate::BlendedOver);
            }
        }
    }

    fn count_fate(&mut self, triangle: TriangleId, fate: FragmentFate) {
        self.fragments[triangle.0 as usize].0[fate as usize] += 1;
    }

    fn count_layers(&mut self, place: usize, fate: FragmentFate) {
        let mut next = std::mem::replace(&mut self.below.pixels_mut()[place], NO_LAYER);
        while let Some(&WrittenFragment { triangle, below }) = self.layers.get(next as usize) {
            self.count_fate(triangle, fate);
            next = below;
        }
    }

    fn covers_all(&self, triangle: &ScreenTriangle, fragment: &Fragment) -> bool {
        let shader = &self.shaders[triangle.instance as usize];
        shader.transparency() != Transparency::Blended || shader.alpha(fragment) >= 1.0
    }
}

impl Observer for FateTally<'_> {
    fn covered(&mut self, _triangle: &ScreenTriangle, _sample: &RasterSample) {
        self.generated += 1;
    }

    fn depth_tested(&mut self, triangle: &ScreenTriangle, _sample: &RasterSample, outcome: DepthOutcome) {
        if !outcome.passed {
            self.count_fate(triangle.id, FragmentFate::LostDepth);
        }
    }

    fn alpha_rejected(&mut self, triangle: &ScreenTriangle, _fragment: &Fragment) {
        self.count_fate(triangle.id, FragmentFate::AlphaRejected);
    }

    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        let RasterSample { column, row, .. } = fragment.sample;
        let place = row as usize * self.top_triangle.width() as usize + column as usize;
        let under = std::mem::replace(&mut self.top_triangle.pixels_mut()[place], triangle.id);
        if under == TriangleId::NONE {
            return;
        }
        if self.covers_all(triangle, fragment) {
            self.count_fate(under, FragmentFate::Overwritten);
            self.count_layers(place, FragmentFate::Overwritten);
        } else {
            let below = self.below.pixels()[place];
            self.below.pixels_mut()[place] = self.layers.len() as u32;
            self.layers.push(WrittenFragment { triangle: under, below });
        }
    }
}
