//! Fates of all triangles of a scene and of all fragments of a frame. Each has exactly one fate, so the counts must add
//! up to the totals.
//!
//! The frame is drawn again with observers, starting at its first stage; normal drawing has no overhead. Fragments are
//! counted at the drawn samples, one at the centre of each pixel; additional anti-aliasing samples are not counted. A
//! clipped triangle counts once, regardless of its number of pieces.

mod account;

mod members;

mod places;

mod rejections;

mod tally;

pub use account::Account;
pub use members::Bin;
pub use members::FateFilter;
pub use places::SelectionVisibility;
pub(crate) use rejections::GeometryOutcome;
pub(crate) use rejections::Rejections;

use serde::{Serialize, Serializer};

use crate::chain::{Frame, Recipe, prepare_again};
use crate::image::Image;
use crate::inspect::selection::TriangleSelection;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::observe::Fate;
use crate::pipeline::settings::{Choice, Culling, choice};
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{DrawCall, Extent, Geometry};
use crate::scene::{Instance, Scene, TriangleId};
use crate::upscale::Sampling;
use places::{ScreenShape, shapes};
use tally::FateTally;

choice! {
    /// Fate of a triangle. A rasterized triangle has the best fate of any of its fragments; better fates are listed
    /// later.
    pub TriangleFate {
        Unaccounted = "unaccounted", "Unaccounted for", "The triangle was neither rejected nor rasterized. Always 0; any other number is a bug in this program.";
        Outside = "outside", "Outside the view", "All corners of the triangle lie beyond the same frustum plane: left, right, top, bottom, near or far.";
        NotFinite = "not-finite", "Non-finite corner", "A corner of the triangle is NaN or infinite, in the model or after the transform.";
        ClippedAway = "clipped-away", "Clipped away", "The triangle crosses several clipping planes, and clipping leaves nothing of it.";
        ZeroArea = "zero-area", "Zero area", "The corners of the triangle are collinear on the screen: there is no area to rasterize.";
        BackFacing = "back-facing", "Back-facing", "The triangle is back-facing and removed by culling. To show it, set culling to none.";
        FrontFacing = "front-facing", "Front-facing", "The triangle is front-facing and removed by culling. To show it, set culling to none.";
        NoCentre = "no-centre", "No pixel centre", "The triangle lies between pixel centres or outside the picture and covers no pixel centre.";
        LostDepth = "lost-depth", "Depth failed", "All fragments of the triangle failed the depth test.";
        AlphaRejected = "alpha-failed", "Alpha failed", "No fragment of the triangle was written: those that passed the depth test failed the alpha test.";
        Overwritten = "overwritten", "Overwritten", "The triangle was drawn, but later fragments cover all of it.";
        BlendedOver = "seen-through", "Blended over", "The triangle is visible only through blended surfaces in front of it.";
        Visible = "visible", "Visible", "The triangle is the front surface of at least one pixel.";
    }
}

choice! {
    /// Fate of a fragment that the rasterizer generated, from worst to best.
    pub FragmentFate {
        LostDepth = "lost-depth", "Depth failed", "The fragment failed the depth test.";
        AlphaRejected = "alpha-failed", "Alpha failed", "The fragment failed the alpha test.";
        Overwritten = "overwritten", "Overwritten", "The fragment was written, but a later fragment covered it: wasted work.";
        BlendedOver = "seen-through", "Blended over", "The fragment was written and is visible through later blended fragments.";
        Visible = "visible", "Visible", "The fragment is the front surface in the finished picture.";
    }
}

impl From<Fate> for TriangleFate {
    fn from(fate: Fate) -> Self {
        match fate {
            Fate::Outside => Self::Outside,
            Fate::NotFinite => Self::NotFinite,
            Fate::ClippedAway => Self::ClippedAway,
            Fate::ZeroArea => Self::ZeroArea,
            Fate::BackFacing => Self::BackFacing,
            Fate::FrontFacing => Self::FrontFacing,
        }
    }
}

/// Numbers of fragments by fate, in the order of [`FragmentFate`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FragmentCounts<N = u32>(pub(crate) [N; FragmentFate::ALL.len()]);

impl<N: Copy + Into<u64>> FragmentCounts<N> {
    /// Returns the number of fragments with this fate.
    pub fn of(&self, fate: FragmentFate) -> u64 {
        self.0[fate as usize].into()
    }

    /// Returns the number of all fragments.
    pub fn sum(&self) -> u64 {
        self.0.iter().map(|count| (*count).into()).sum()
    }

    /// Returns the best fate among the fragments, the last in [`FragmentFate::ALL`]; `None` without fragments.
    fn best(&self) -> Option<FragmentFate> {
        FragmentFate::ALL.iter().rev().copied().find(|fate| self.of(*fate) > 0)
    }
}

/// Numbers of triangles by fate, in the order of [`TriangleFate`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TriangleCounts(pub(crate) [u64; TriangleFate::ALL.len()]);

impl TriangleCounts {
    /// Returns the number of triangles with this fate.
    pub fn of(&self, fate: TriangleFate) -> u64 {
        self.0[fate as usize]
    }

    /// Returns the number of all triangles.
    pub fn sum(&self) -> u64 {
        self.0.iter().sum()
    }
}

/// Serialises the counts as a map from the id of each fate to its count.
fn by_id<C: Choice, S: Serializer>(count: impl Fn(C) -> u64, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(C::ALL.iter().map(|fate| (fate.id(), count(*fate))))
}

impl Serialize for TriangleCounts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        by_id(|fate| self.of(fate), serializer)
    }
}

impl<N: Copy + Into<u64>> Serialize for FragmentCounts<N> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        by_id(|fate| self.of(fate), serializer)
    }
}

/// Fates of the triangles and fragments of one object.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ObjectFates {
    /// Name of the object.
    pub name: String,
    /// Name of the object's material.
    pub(crate) material: String,
    /// Id of the first triangle of the object.
    #[serde(rename = "first_triangle")]
    pub(crate) first: TriangleId,
    /// Numbers of the object's triangles by fate.
    pub triangles: TriangleCounts,
    /// Numbers of the object's fragments by fate.
    pub fragments: FragmentCounts<u64>,
}

/// Fates of all triangles and fragments of a frame.
#[derive(Clone, Debug)]
pub struct Fates {
    /// Fate of every triangle, in scene order.
    pub triangles: Vec<TriangleFate>,
    /// Numbers of fragments by fate for every triangle, in scene order.
    pub fragments: Vec<FragmentCounts>,
    /// Fates per object (instance), in scene order.
    pub objects: Vec<ObjectFates>,
    /// Totals at the input and output of the pipeline, for checking that every triangle and fragment is counted once.
    pub account: Account,
    /// Triangles that crossed a frustum plane and were clipped.
    pub(crate) cut: TriangleSelection,
    /// Triangles with a NaN or infinite normal or texture coordinate in the model.
    pub broken: TriangleSelection,
    /// Triangle written last at each drawn sample, in the packed layout of the frame's framebuffer.
    top_triangle: Image<TriangleId>,
    /// Screen-space shapes of all triangles, including culled ones, in scene order.
    shapes: Vec<ScreenShape>,
    recipe: Recipe,
    sampling: Sampling,
    /// Size of the raster image, in pixels.
    raster: Viewport,
    /// Size of the full picture, in pixels.
    viewport: Viewport,
}

impl Fates {
    /// Computes the fates of all triangles of `scene`, and of their fragments, when the scene is drawn with `recipe`.
    /// All triangles are drawn, even if `frame` stops after the first few.
    ///
    /// # Examples
    /// ```
    /// # use rasterscope_engine::chain::{Recipe, run};
    /// # use rasterscope_engine::pipeline::viewport::Viewport;
    /// # use rasterscope_engine::scene::builtin;
    /// #
    /// # let scene = builtin::by_id("interpenetrating").unwrap().build();
    /// # let (recipe, viewport) = (Recipe::default(), Viewport { width: 64, height: 36 });
    /// # let frame = run(&scene, &scene.home, &recipe, viewport, &mut ());
    /// use rasterscope_engine::inspect::fates::{Fates, TriangleFate};
    ///
    /// let fates = Fates::of(&scene, &recipe, &frame);
    /// assert_eq!(fates.triangles, [TriangleFate::Visible; 2]);
    /// assert_eq!(fates.triangle_counts().sum(), 2);
    /// assert!(fates.account.is_balanced());
    /// ```
    pub fn of(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        let mut rejections = Rejections::new(scene.triangle_count());
        let geometry = prepare_again(scene, recipe, frame, &mut rejections);
        let (grid, Viewport { width, height }) = (frame.sampling.grid(), frame.raster);
        let mut drawn = Framebuffer::new(grid, width, height, scene.background, &recipe.pipeline);
        let mut tally = FateTally::new(scene, recipe, &geometry, drawn.color.size());
        let extent = Extent::all(&geometry, frame.raster);
        DrawCall::new(scene, &geometry, &recipe.pipeline, &extent).draw(&mut drawn, &mut tally);
        tally.finish();

        let triangles = triangle_fates(&geometry, &rejections, &tally.fragments);
        let account = Account::of(&geometry, &rejections, &tally);
        let objects = objects(scene, &triangles, &tally.fragments);
        let FateTally { fragments, top_triangle, .. } = tally;
        Self {
            shapes: shapes(&with_all_sides(scene, recipe, frame, geometry), recipe.pipeline.arithmetic),
            triangles,
            fragments,
            objects,
            account,
            cut: TriangleSelection::new("clipped at the near plane, far plane or guard band", rejections.cut),
            broken: TriangleSelection::new("with a NaN or infinite attribute", scene.broken_triangles()),
            top_triangle,
            recipe: *recipe,
            sampling: frame.sampling,
            raster: frame.raster,
            viewport: frame.viewport,
        }
    }

    /// Returns the number of triangles with each fate.
    pub fn triangle_counts(&self) -> TriangleCounts {
        let mut sum = TriangleCounts::default();
        self.triangles.iter().for_each(|fate| sum.0[*fate as usize] += 1);
        sum
    }

    /// Returns the number of fragments with each fate.
    pub fn fragment_counts(&self) -> FragmentCounts<u64> {
        sum(&self.fragments)
    }

    /// Returns the index of the instance that a triangle belongs to.
    pub fn object_of(&self, triangle: TriangleId) -> usize {
        self.objects.partition_point(|object| object.first <= triangle).saturating_sub(1)
    }
}

/// Returns the fate of each triangle, in scene order.
fn triangle_fates(geometry: &Geometry, rejections: &Rejections, fragments: &[FragmentCounts]) -> Vec<TriangleFate> {
    let mut fates: Vec<_> =
        rejections.fates.iter().map(|fate| fate.map_or(TriangleFate::Unaccounted, Into::into)).collect();
    for triangle in &geometry.triangles {
        let place = triangle.id.0 as usize;
        fates[place] = match fragments[place].best() {
            None => TriangleFate::NoCentre,
            Some(FragmentFate::LostDepth) => TriangleFate::LostDepth,
            Some(FragmentFate::AlphaRejected) => TriangleFate::AlphaRejected,
            Some(FragmentFate::Overwritten) => TriangleFate::Overwritten,
            Some(FragmentFate::BlendedOver) => TriangleFate::BlendedOver,
            Some(FragmentFate::Visible) => TriangleFate::Visible,
        };
    }
    fates
}

/// Returns the geometry of a frame including the triangles that are culled as back-facing or front-facing.
fn with_all_sides(scene: &Scene, recipe: &Recipe, frame: &Frame, geometry: Geometry) -> Geometry {
    if recipe.pipeline.culling == Culling::None {
        return geometry;
    }
    let mut all = *recipe;
    all.pipeline.culling = Culling::None;
    prepare_again(scene, &all, frame, &mut ())
}

fn objects(scene: &Scene, triangles: &[TriangleFate], fragments: &[FragmentCounts]) -> Vec<ObjectFates> {
    let places = scene.instances.iter().zip(scene.first_triangles());
    let object = |(instance, first): (&Instance, TriangleId)| {
        let range = first.0 as usize..first.0 as usize + scene.library.mesh(instance.mesh).triangles.len();
        let mut counts = TriangleCounts::default();
        triangles[range.clone()].iter().for_each(|fate| counts.0[*fate as usize] += 1);
        let material = scene.library.material(instance.material).name.clone();
        ObjectFates {
            name: instance.name.clone(),
            material,
            first,
            triangles: counts,
            fragments: sum(&fragments[range]),
        }
    };
    places.map(object).collect()
}

fn sum(counts: &[FragmentCounts]) -> FragmentCounts<u64> {
    let mut sum = FragmentCounts::default();
    for counts in counts {
        sum.0.iter_mut().zip(counts.0).for_each(|(sum, count)| *sum += u64::from(count));
    }
    sum
}

#[cfg(test)]
mod tests;
