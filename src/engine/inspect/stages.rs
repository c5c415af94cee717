//! Pictures of one view after each pipeline stage.
//!
//! Stages up to culling show the whole scene as lines and dots: all projected triangles after clipping, without face
//! culling. Only zero-area triangles are missing, because they have no facing. Stages from rasterization onwards show
//! only pixels that were drawn; pixels left to the upscaler are dark.

use super::buffers::Buffer;
use super::fates::Rejections;
use super::view::{self, NOT_DRAWN};
use crate::chain::{Frame, Recipe, redraw};
use crate::image::{Image, Rgba8};
use crate::math::fixed::to_pixels;
use crate::pipeline::cull::cull;
use crate::pipeline::observe::Observer;
use crate::pipeline::plan::culling;
use crate::pipeline::raster::{RasterSample, doubled_area};
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::settings::{Choice, Culling, Settings, Shading, choice};
use crate::pipeline::shade::id_color;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{LastStage, prepare, wireframe};
use crate::scene::{Camera, Scene};

choice! {
    /// Pipeline stage whose result can be displayed.
    pub Stage {
        Assemble = "assemble", "Assemble", "Corners of all triangles that reach into the view, as dots. Clipped triangles are shown by the corners of their pieces.";
        Transform = "transform", "Transform", "Vertices from model through world and view to clip space: the edges of all triangles that reach into the view, front- and back-facing.", also ["fov", "field of view", "camera", "projection"];
        Clip = "clip", "Clip", "Triangles outside the view are removed; pieces of triangles clipped at the near plane, the far plane or the guard band are orange.";
        Project = "project", "Project", "Edges and corners after the division by w, scaled to pixels and snapped to 1/256 px.";
        Cull = "cull", "Cull", "Triangles to rasterize are white, culled ones red. Zero-area triangles are not shown.";
        Rasterize = "rasterize", "Rasterize", "Every covered pixel in the colour of the last triangle drawn there, before the depth and alpha tests. Pixels that the upscaler fills in are dark.";
        Depth = "depth", "Depth", "The depth buffer after the depth and alpha tests. Blended fragments store no depth.";
        Interpolate = "interpolate", "Interpolate", "The weights of the winning triangle's corners as red, green and blue.";
        Shade = "shade", "Shade", "The drawn pixels after shading; those that the upscaler fills in are dark.";
        Upscale = "upscale", "Upscale", "The finished picture.";
    }
}

impl Stage {
    /// Returns the stage that lies `steps` stages after this one, or before it if `steps` is negative. Stops at the
    /// first and the last stage.
    pub fn stepped(self, steps: i64) -> Self {
        let last = Self::ALL.len() as i64 - 1;
        let place = Self::ALL.iter().position(|stage| *stage == self).map_or(0, |place| place as i64);
        Self::ALL[place.saturating_add(steps).clamp(0, last) as usize]
    }

    /// Returns the buffer that holds the values of the picture after this stage; `None` if the picture has only colours.
    pub fn buffer(self) -> Option<Buffer> {
        match self {
            Self::Depth => Some(Buffer::Depth),
            Self::Upscale => Some(Buffer::Color),
            Self::Assemble
            | Self::Transform
            | Self::Clip
            | Self::Project
            | Self::Cull
            | Self::Rasterize
            | Self::Interpolate
            | Self::Shade => None,
        }
    }
}

const BACKGROUND_COLOR: Rgba8 = [20, 20, 20, 255];
const REMAINING_COLOR: Rgba8 = [222, 222, 222, 255];
const CLIPPED_COLOR: Rgba8 = [240, 150, 40, 255];
const REJECTED_COLOR: Rgba8 = [214, 72, 72, 255];

/// Returns the picture of `frame` after the pipeline stage `stage`.
pub fn picture(scene: &Scene, camera: &Camera, recipe: &Recipe, frame: &Frame, stage: Stage) -> Image<Rgba8> {
    match stage {
        Stage::Assemble => Wires::of(scene, camera, recipe, frame.viewport).corners(),
        Stage::Transform => Wires::of(scene, camera, recipe, frame.viewport).edges(|_| REMAINING_COLOR),
        Stage::Clip => {
            let wires = Wires::of(scene, camera, recipe, frame.viewport);
            wires.edges(|t| if wires.rejections.is_cut(t.id) { CLIPPED_COLOR } else { REMAINING_COLOR })
        }
        Stage::Project => {
            let wires = Wires::of(scene, camera, recipe, frame.viewport);
            let mut image = wires.edges(|_| [110, 110, 110, 255]);
            wires.dots(&mut image);
            image
        }
        Stage::Cull => {
            let wires = Wires::of(scene, camera, recipe, frame.viewport);
            let mut image = wires.edges(|_| REJECTED_COLOR);
            for triangle in wires.triangles.iter().filter(|t| is_kept(t, scene, &recipe.pipeline)) {
                plot(triangle, REMAINING_COLOR, &mut image);
            }
            image
        }
        Stage::Rasterize => {
            let (width, height) = frame.drawn.color.size();
            let [r, g, b] = recipe.pipeline.background.resolve(scene.background);
            let mut covered = LastCovered(Image::filled(width, height, [r, g, b, 255]));
            redraw(scene, recipe, frame, LastStage::Coverage, &mut covered);
            spread(&covered.0, frame)
        }
        Stage::Depth => view::picture(Buffer::Depth, frame, None, view::range(Buffer::Depth, frame, None)),
        Stage::Interpolate => {
            let pipeline = Settings { shading: Shading::Barycentric, ..recipe.pipeline };
            let recipe = Recipe { pipeline, ..*recipe };
            spread(&redraw(scene, &recipe, frame, LastStage::Shade, &mut ()).color, frame)
        }
        Stage::Shade => spread(&frame.drawn.color, frame),
        Stage::Upscale => frame.image().clone(),
    }
}

/// Observer that colours each sample by the last triangle that covers it.
struct LastCovered(Image<Rgba8>);

impl Observer for LastCovered {
    fn covered(&mut self, triangle: &ScreenTriangle, sample: &RasterSample) {
        self.0.set(sample.column, sample.row, id_color(triangle.id));
    }
}

/// Returns the full picture with the drawn pixels at their positions; all others have the colour [`NOT_DRAWN`].
fn spread(packed: &Image<Rgba8>, frame: &Frame) -> Image<Rgba8> {
    let Viewport { width, height } = frame.viewport;
    Image::from_fn(width, height, |x, y| {
        frame.sample_at(x, y).map_or(NOT_DRAWN, |(column, row)| packed.at(column, row))
    })
}

fn is_kept(triangle: &ScreenTriangle, scene: &Scene, settings: &Settings) -> bool {
    let (area, _) = doubled_area(settings.arithmetic, triangle.corners_px());
    let culling = culling(&scene.library, &scene.instances[triangle.instance as usize], settings);
    cull(area, culling).is_none()
}

/// All projected triangles before face culling, for drawing as lines.
struct Wires {
    triangles: Vec<ScreenTriangle>,
    rejections: Rejections,
    viewport: Viewport,
}

impl Wires {
    fn of(scene: &Scene, camera: &Camera, recipe: &Recipe, viewport: Viewport) -> Self {
        let mut settings = recipe.pipeline;
        settings.culling = Culling::None;
        let mut rejections = Rejections::new(scene.triangle_count());
        let triangles = prepare(scene, camera, &settings, viewport, &mut rejections).triangles;
        Self { triangles: triangles.into_vec(), rejections, viewport }
    }

    fn blank(&self) -> Image<Rgba8> {
        Image::filled(self.viewport.width, self.viewport.height, BACKGROUND_COLOR)
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
            // Dots of 2×2 pixels, because a single pixel is hard to see.
            for (dx, dy) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)] {
                let (x, y) = (x + dx, y + dy);
                if x >= 0.0 && y >= 0.0 && x < width as f32 && y < height as f32 {
                    image.set(x as u32, y as u32, REMAINING_COLOR);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::run;
    use crate::pipeline::settings::DepthTest;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    const VIEW: Viewport = Viewport { width: 80, height: 60 };

    /// Counts the pixels of a picture that are neither background nor undrawn.
    fn covered(scene: &Scene, image: &Image<Rgba8>) -> usize {
        let [r, g, b] = scene.background;
        image.pixels().iter().filter(|p| ![[r, g, b, 255], NOT_DRAWN].contains(p)).count()
    }

    #[test]
    fn pictures_of_samples_are_redrawn_bit_for_bit() {
        let scene = builtin::by_id("cubes").unwrap().build();
        let mut recipe = Recipe::default();
        let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
        let shown = picture(&scene, &scene.home, &recipe, &frame, Stage::Interpolate);
        recipe.pipeline.shading = Shading::Barycentric;
        assert_eq!(shown, *run(&scene, &scene.home, &recipe, VIEW, &mut ()).image());
    }

    #[test]
    fn pictures_of_samples_show_no_triangle_beyond_the_limit_and_no_pixel_beyond_the_grid() {
        let scene = builtin::by_id("cubes").unwrap().build();
        let recipe = Recipe { upscaler: Upscaling::new("nearest", 2_u32).unwrap(), ..Recipe::default() };
        let mut frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
        for stage in [Stage::Rasterize, Stage::Depth, Stage::Interpolate] {
            let image = picture(&scene, &scene.home, &recipe, &frame, stage);
            assert!(covered(&scene, &image) > 50, "{stage:?}");
            assert_eq!([image.at(1, 0), image.at(0, 1), image.at(33, 31)], [NOT_DRAWN; 3], "{stage:?}");
        }
        frame.geometry_mut().triangles.truncate(1);
        let only = id_color(frame.geometry().triangles[0].id);
        let image = picture(&scene, &scene.home, &recipe, &frame, Stage::Rasterize);
        let of_it = image.pixels().iter().filter(|p| **p == only).count();
        assert!(of_it > 0 && of_it == covered(&scene, &image));
    }

    #[test]
    fn the_depth_stage_shows_the_stored_depths() {
        // The scene has opaque, alpha-tested and blended triangles.
        let scene = builtin::by_id("stained-glass").unwrap().build();
        let mut recipe = Recipe::default();
        let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
        let image = picture(&scene, &scene.home, &recipe, &frame, Stage::Depth);
        let depth = frame.drawn.depth.as_ref().unwrap();
        let range = view::range(Buffer::Depth, &frame, None).unwrap();
        for (color, depth) in image.pixels().iter().zip(depth.pixels()) {
            let is_stored = *depth != frame.drawn.clear_depth;
            let expected = if is_stored { view::magnitude_color(range.position(*depth)) } else { NOT_DRAWN };
            assert_eq!(*color, expected);
        }
        assert!(range.low < range.high);
        recipe.pipeline.depth_test = DepthTest::Off;
        let frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
        let image = picture(&scene, &scene.home, &recipe, &frame, Stage::Depth);
        assert!(image.pixels().iter().all(|color| *color == NOT_DRAWN), "there is no depth buffer");
    }

    #[test]
    fn steps_stop_at_the_first_and_the_last_stage() {
        assert_eq!(Stage::Cull.stepped(1), Stage::Rasterize);
        assert_eq!(Stage::Clip.stepped(-1), Stage::Transform);
        assert_eq!(Stage::Assemble.stepped(-1), Stage::Assemble);
        assert_eq!(Stage::Shade.stepped(i64::MAX), Stage::Upscale);
    }

    #[test]
    fn triangles_beyond_the_limit_do_not_look_culled() {
        let scene = builtin::by_id("cubes").unwrap().build();
        let mut recipe = Recipe::default();
        recipe.pipeline.culling = Culling::None;
        let mut frame = run(&scene, &scene.home, &recipe, VIEW, &mut ());
        frame.geometry_mut().triangles.truncate(3);
        let image = picture(&scene, &scene.home, &recipe, &frame, Stage::Cull);
        assert!(image.pixels().contains(&REMAINING_COLOR) && !image.pixels().contains(&REJECTED_COLOR));
    }
}
