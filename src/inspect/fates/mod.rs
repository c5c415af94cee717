//! How every triangle of a scene and every fragment of a frame ended: each in exactly one bin, so that the sums must match.
//!
//! The frame is made once more, from its first stage on, with observers; the frame itself pays nothing for it. Fragments are
//! those at the samples that are drawn, one for each pixel at its centre; further samples of an anti-aliased pixel are not
//! counted. A triangle counts once, into however many pieces it was cut.

mod account;

mod members;

mod places;

mod rejections;

mod tally;

pub use account::Account;
pub use members::{Bin, Filter};
pub use places::Mark;
pub use rejections::{Met, Rejections};

use serde::{Serialize, Serializer};

use crate::chain::{Frame, Recipe, prepare_again};
use crate::image::Image;
use crate::inspect::selection::TriangleSelection;
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::observe::Fate;
use crate::pipeline::settings::{Choice, Culling, choice};
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{Extent, Geometry, Until, draw};
use crate::scene::{Instance, Scene, TriangleId};
use crate::upscale::Sampling;
use places::{Shape, shapes};
use tally::Tally;

choice! {
    /// How a triangle ended. Of those that were rasterized it is as far as the best of their fragments came.
    TriangleFate {
        Unaccounted = "unaccounted", "Unaccounted for", "Neither rejected nor rasterized. There must be none: it would be a fault of this program.";
        Outside = "outside", "Outside the view", "All corners lie beyond the same side of the view: left, right, top, bottom, near or far.";
        NotFinite = "not-finite", "Corner not finite", "A corner is infinite or not a number, in the model or after its transformation.";
        ClippedAway = "clipped-away", "Clipped away", "It crosses several sides of the view, and nothing of it is left between them.";
        ZeroArea = "zero-area", "Zero area", "On the screen its corners lie on one line.";
        BackFacing = "back-facing", "Back-facing", "It turns its back, and such triangles are dropped.";
        FrontFacing = "front-facing", "Front-facing", "It faces the viewer, and such triangles are dropped.";
        NoCentre = "no-centre", "No pixel centre", "It lies between the centres of pixels or beside the picture, and covers none.";
        LostDepth = "lost-depth", "Lost depth", "All of its fragments lost the depth test: what was drawn before is nearer.";
        CutOut = "cut-out", "Cut out", "None of its fragments was written: those that passed the depth test are holes of its texture.";
        Overwritten = "overwritten", "Overwritten", "It was drawn, and what came later covers all of it.";
        SeenThrough = "seen-through", "Seen through", "It is seen, but only through translucent surfaces before it.";
        Visible = "visible", "Visible", "It is on top in at least one pixel.";
    }
}

choice! {
    /// How a fragment ended.
    FragmentFate {
        LostDepth = "lost-depth", "Lost depth", "It lost the depth test: what was drawn before is nearer.";
        CutOut = "cut-out", "Cut out", "Its texture has a hole there.";
        Overwritten = "overwritten", "Overwritten", "It was written, and a later fragment covered it: work in vain.";
        SeenThrough = "seen-through", "Seen through", "It was written, and is seen through what was blended over it.";
        Visible = "visible", "Visible", "It is on top in the finished picture.";
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

/// Fragments by their ends, in the order of [`FragmentFate`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FragmentCounts<N = u32>(pub [N; FragmentFate::ALL.len()]);

impl<N: Copy + Into<u64>> FragmentCounts<N> {
    /// How many ended so.
    pub fn of(&self, fate: FragmentFate) -> u64 {
        self.0[fate as usize].into()
    }

    /// All of them.
    pub fn sum(&self) -> u64 {
        self.0.iter().map(|count| (*count).into()).sum()
    }

    /// As far as the best of them came; `None` if there are none.
    fn best(&self) -> Option<FragmentFate> {
        FragmentFate::ALL.iter().rev().copied().find(|fate| self.of(*fate) > 0)
    }
}

/// Triangles by their ends, in the order of [`TriangleFate`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TriangleCounts(pub [u64; TriangleFate::ALL.len()]);

impl TriangleCounts {
    /// How many ended so.
    pub fn of(&self, fate: TriangleFate) -> u64 {
        self.0[fate as usize]
    }

    /// All of them.
    pub fn sum(&self) -> u64 {
        self.0.iter().sum()
    }
}

/// Writes the counts of bins as a map from their ids.
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

/// Where the triangles and fragments of one object went.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ObjectFates {
    /// Its name.
    pub name: String,
    /// The name of its material.
    pub material: String,
    /// Its first triangle.
    #[serde(rename = "first_triangle")]
    pub first: TriangleId,
    /// Its triangles.
    pub triangles: TriangleCounts,
    /// Its fragments.
    pub fragments: FragmentCounts<u64>,
}

/// The ends of everything in a frame.
#[derive(Clone, Debug)]
pub struct Fates {
    /// Of every triangle of the scene.
    pub triangles: Vec<TriangleFate>,
    /// The fragments of every triangle of the scene.
    pub fragments: Vec<FragmentCounts>,
    /// The same per instance.
    pub objects: Vec<ObjectFates>,
    /// Whether the sums match.
    pub account: Account,
    /// Triangles that crossed a plane of the view and were cut.
    pub cut: TriangleSelection,
    /// Triangles with a normal or texture coordinate that was not finite in the model.
    pub broken: TriangleSelection,
    /// The triangle that was written last into each sample that is drawn, packed as the frame's framebuffer is.
    shown: Image<TriangleId>,
    /// What of each triangle reached the screen, whichever side it shows, in the order of the scene.
    shapes: Vec<Shape>,
    recipe: Recipe,
    sampling: Sampling,
    /// Size of the picture that was drawn.
    raster: Viewport,
    /// Size of the full picture.
    viewport: Viewport,
}

impl Fates {
    /// Of the frame that `recipe` made of `scene`: of all of its triangles, even if `frame` holds only the first.
    pub fn of(scene: &Scene, recipe: &Recipe, frame: &Frame) -> Self {
        let mut rejections = Rejections::new(scene.triangle_count());
        let geometry = prepare_again(scene, recipe, frame, &mut rejections);
        let (grid, Viewport { width, height }) = (frame.sampling.grid(), frame.raster);
        let mut drawn = Framebuffer::new(grid, width, height, scene.background, &recipe.pipeline);
        let mut tally = Tally::new(scene, recipe, &geometry, drawn.color.size());
        let extent = Extent::all(&geometry, frame.raster);
        draw(scene, &geometry, &recipe.pipeline, &extent, Until::Shade, &mut drawn, &mut tally);
        tally.finish();

        let triangles = endings(&geometry, &rejections, &tally.fragments);
        let account = Account::of(&geometry, &rejections, &tally);
        let objects = objects(scene, &triangles, &tally.fragments);
        let Tally { fragments, shown, .. } = tally;
        Self {
            shapes: shapes(&with_all_sides(scene, recipe, frame, geometry), recipe.pipeline.arithmetic),
            triangles,
            fragments,
            objects,
            account,
            cut: TriangleSelection::new("cut by a plane of the view", rejections.cut),
            broken: TriangleSelection::new("with an attribute that was not finite", scene.broken_triangles()),
            shown,
            recipe: *recipe,
            sampling: frame.sampling,
            raster: frame.raster,
            viewport: frame.viewport,
        }
    }

    /// All triangles by their ends.
    pub fn triangle_counts(&self) -> TriangleCounts {
        let mut sum = TriangleCounts::default();
        self.triangles.iter().for_each(|fate| sum.0[*fate as usize] += 1);
        sum
    }

    /// All fragments by their ends.
    pub fn fragment_counts(&self) -> FragmentCounts<u64> {
        sum(&self.fragments)
    }

    /// The instance that a triangle belongs to.
    pub fn object_of(&self, triangle: TriangleId) -> usize {
        self.objects.partition_point(|object| object.first <= triangle).saturating_sub(1)
    }
}

/// Where each triangle ended.
fn endings(geometry: &Geometry, rejections: &Rejections, fragments: &[FragmentCounts]) -> Vec<TriangleFate> {
    let mut fates: Vec<_> =
        rejections.fates.iter().map(|fate| fate.map_or(TriangleFate::Unaccounted, Into::into)).collect();
    for triangle in &geometry.triangles {
        let place = triangle.id.0 as usize;
        fates[place] = match fragments[place].best() {
            None => TriangleFate::NoCentre,
            Some(FragmentFate::LostDepth) => TriangleFate::LostDepth,
            Some(FragmentFate::CutOut) => TriangleFate::CutOut,
            Some(FragmentFate::Overwritten) => TriangleFate::Overwritten,
            Some(FragmentFate::SeenThrough) => TriangleFate::SeenThrough,
            Some(FragmentFate::Visible) => TriangleFate::Visible,
        };
    }
    fates
}

/// The triangles on the screen with those that culling dropped.
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
