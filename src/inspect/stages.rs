//! The picture after each stage: the same view, drawn as far as the pipeline has come.

use crate::chain::{Frame, Recipe, run};
use crate::image::{Image, Rgba8};
use crate::math::fixed::to_pixels;
use crate::pipeline::observe::Observer;
use crate::pipeline::settings::{Choice, Culling, DepthTest, Shading, choice};
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{prepare, wireframe};
use crate::scene::{Camera, Scene, TriangleId};
use crate::upscale::Upscaling;

choice! {
    /// A stage whose result can be looked at.
    Stage {
        Assemble = "assemble", "Assemble", "Meshes and instances: every vertex as a dot where it will be seen.";
        Transform = "transform", "Transform", "Vertices through model, world and view into clip space: all edges, front and back.";
        Clip = "clip", "Clip", "Triangles that reach out of the view are cut: pieces of cut triangles in orange.";
        Project = "project", "Project", "Divided by w, scaled to pixels, snapped to 1/256 px: edges and snapped corners.";
        Cull = "cull", "Cull", "What is left to rasterize in white; what was dropped for its facing or lack of area in red.";
        Rasterize = "rasterize", "Rasterize", "Every covered pixel in the colour of the last triangle drawn there; no depth yet.";
        Depth = "depth", "Depth", "The depth test decides who stays: the colour of the winning triangle.";
        Interpolate = "interpolate", "Interpolate", "The weights of the winner's three corners as red, green and blue.";
        Shade = "shade", "Shade", "The pixels that are really drawn, shaded; those left to the upscaler are dark.";
        Upscale = "upscale", "Upscale", "The finished picture.";
    }
}

const BACKDROP: Rgba8 = [20, 20, 20, 255];
const KEPT: Rgba8 = [222, 222, 222, 255];
const CUT: Rgba8 = [240, 150, 40, 255];
const DROPPED: Rgba8 = [214, 72, 72, 255];

/// Shown where no pixel was drawn.
pub const NOT_DRAWN: Rgba8 = [12, 12, 12, 255];

/// The picture after `stage` of the frame that `recipe` gives.
pub fn picture(scene: &Scene, camera: &Camera, recipe: &Recipe, frame: &Frame, stage: Stage) -> Image<Rgba8> {
    let redrawn = |recipe: Recipe| run(scene, camera, &recipe, frame.viewport, &mut ()).image;
    let native = Recipe { upscaler: Upscaling::NATIVE, wireframe: false, ..*recipe };
    match stage {
        Stage::Assemble => Wires::of(scene, camera, recipe, frame.viewport).corners(),
        Stage::Transform => Wires::of(scene, camera, recipe, frame.viewport).edges(|_| KEPT),
        Stage::Clip => {
            let wires = Wires::of(scene, camera, recipe, frame.viewport);
            wires.edges(|t| if wires.fates.cut.binary_search(&t.id).is_ok() { CUT } else { KEPT })
        }
        Stage::Project => {
            let wires = Wires::of(scene, camera, recipe, frame.viewport);
            let mut image = wires.edges(|_| [110, 110, 110, 255]);
            wires.dots(&mut image);
            image
        }
        Stage::Cull => {
            let wires = Wires::of(scene, camera, recipe, frame.viewport);
            let mut image = wires.edges(|_| DROPPED);
            for triangle in &frame.geometry.triangles {
                plot(triangle, KEPT, &mut image);
            }
            image
        }
        Stage::Rasterize => {
            let mut recipe = native;
            recipe.pipeline.shading = Shading::TriangleId;
            recipe.pipeline.depth_test = DepthTest::Off;
            redrawn(recipe)
        }
        Stage::Depth => redrawn(with_shading(native, Shading::TriangleId)),
        Stage::Interpolate => redrawn(with_shading(native, Shading::Barycentric)),
        Stage::Shade => spread(frame),
        Stage::Upscale => frame.image.clone(),
    }
}

fn with_shading(mut recipe: Recipe, shading: Shading) -> Recipe {
    recipe.pipeline.shading = shading;
    recipe
}

/// The drawn pixels at their places in the full picture.
fn spread(frame: &Frame) -> Image<Rgba8> {
    let Viewport { width, height } = frame.viewport;
    Image::from_fn(width, height, |x, y| {
        frame.drawn.grid.sample_at(x, y).map_or(NOT_DRAWN, |(column, row)| frame.drawn.color.at(column, row))
    })
}

/// All triangles before culling, as lines.
struct Wires {
    triangles: Vec<ScreenTriangle>,
    fates: CutTriangles,
    viewport: Viewport,
}

/// Which triangles were cut, ascending.
#[derive(Default)]
struct CutTriangles {
    cut: Vec<TriangleId>,
}

impl Observer for CutTriangles {
    fn clipped(&mut self, id: TriangleId, _pieces: usize) {
        self.cut.push(id);
    }
}

impl Wires {
    fn of(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Self {
        let mut settings = recipe.pipeline;
        settings.culling = Culling::None;
        let mut fates = CutTriangles::default();
        let triangles = prepare(scene, camera, &settings, viewport, &mut fates).triangles;
        Self { triangles, fates, viewport }
    }

    fn blank(&self) -> Image<Rgba8> {
        Image::filled(self.viewport.width, self.viewport.height, BACKDROP)
    }

    fn edges(&self, color: impl Fn(&ScreenTriangle) -> Rgba8) -> Image<Rgba8> {
        let mut image = self.blank();
        for triangle in &self.triangles {
            plot(triangle, color(triangle), &mut image);
        }
        image
    }

    fn corners(&self) -> Image<Rgba8> {
        let mut image = self.blank();
        self.dots(&mut image);
        image
    }

    fn dots(&self, image: &mut Image<Rgba8>) {
        let (width, height) = image.size();
        for corner in self.triangles.iter().flat_map(|t| &t.vertices) {
            let [x, y] = [corner.x, corner.y].map(|c| to_pixels(c.into()).floor());
            // Two by two: one pixel is hard to see.
            for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let (x, y) = (x + dx, y + dy);
                if x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32 {
                    image.set(x as u32, y as u32, KEPT);
                }
            }
        }
    }
}

fn plot(triangle: &ScreenTriangle, color: Rgba8, image: &mut Image<Rgba8>) {
    for (x, y) in wireframe::edge_pixels(triangle, image.size()) {
        image.set(x, y, color);
    }
}
