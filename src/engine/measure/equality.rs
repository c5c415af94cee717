//! Check that a view is bit-identical in classic and tiled execution, with every SIMD instruction set and any number of
//! threads.

use std::sync::Arc;

use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};
use serde::Serialize;

use crate::chain::{Frame, KeepDepth, Recipe, RenderInputs, Renderer, execution};
use crate::image::Image;
use crate::math::lanes::Lanes;
use crate::pipeline::settings::Execution;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};

/// Quantity in which frames are compared, in pipeline order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ComparedQuantity {
    /// Colours of the rasterized samples.
    Color,
    /// Stored depths of the rasterized samples.
    Depth,
    /// Pixels of the finished image.
    Picture,
}

/// First difference between two frames.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FrameDifference {
    /// First quantity in pipeline order that differs.
    pub quantity: ComparedQuantity,
    /// Number of samples or pixels that differ in this quantity.
    pub samples: usize,
    /// Column and row of the first differing sample in row-major order.
    pub first: (u32, u32),
    /// Value in the reference, or its image size if the sizes differ.
    pub expected: String,
    /// Value in the other frame, or its image size if the sizes differ.
    pub found: String,
}

impl FrameDifference {
    /// Creates a difference that cannot be located at a sample, such as different image sizes.
    fn as_a_whole(quantity: ComparedQuantity, [expected, found]: [String; 2]) -> Self {
        Self { quantity, samples: 1, first: (0, 0), expected, found }
    }
}

/// Configuration of tiled execution, and its result.
#[derive(Clone, Debug, Serialize)]
pub struct ExecutionVariant {
    /// Name of the SIMD instruction set.
    pub lanes: &'static str,
    /// Number of threads that drew the frame.
    pub threads: usize,
    /// First difference from the classic frame; `None` if the frames are identical.
    pub difference: Option<FrameDifference>,
}

/// Result of comparing classic and tiled execution.
#[derive(Clone, Debug, Serialize)]
pub struct Equality {
    /// All configurations that were compared.
    pub ways: Vec<ExecutionVariant>,
    /// Reason why tiled execution cannot draw the recipe; `None` if it can.
    pub obstacle: Option<&'static str>,
}

/// Stack size of a render thread, in bytes. The default is too small for unoptimised builds, whose kernels for several
/// instruction sets need large stack frames.
const STACK_BYTES: usize = 8 << 20;

/// Renders a view in classic execution, then in tiled execution with every SIMD instruction set of the processor and
/// every given number of threads, and compares the frames.
///
/// # Errors
///
/// Fails if a thread pool cannot be started.
pub fn verify(
    scene: &Arc<Scene>,
    camera: &Camera,
    recipe: &Recipe,
    viewport: Viewport,
    threads: &[usize],
) -> Result<Equality, ThreadPoolBuildError> {
    let by = |execution| Recipe { execution, ..*recipe };
    let (classic, tiled) = (by(Execution::Classic), by(Execution::Tiled));
    if let (Execution::Classic, obstacle) = execution(scene, &tiled) {
        return Ok(Equality { ways: Vec::new(), obstacle });
    }
    let expected =
        Renderer::default().render(RenderInputs { scene, camera, recipe: &classic, viewport }, KeepDepth::Yes);
    let mut ways = Vec::new();
    for &count in threads {
        let pool = ThreadPoolBuilder::new().num_threads(count).stack_size(STACK_BYTES).build()?;
        for lanes in Lanes::all() {
            let draw =
                || Renderer::on(lanes).render(RenderInputs { scene, camera, recipe: &tiled, viewport }, KeepDepth::Yes);
            let difference = difference(&expected, &pool.install(draw));
            ways.push(ExecutionVariant { lanes: lanes.name(), threads: count, difference });
        }
    }
    Ok(Equality { ways, obstacle: None })
}

/// Returns the first difference of a frame from the expected one.
fn difference(expected: &Frame, found: &Frame) -> Option<FrameDifference> {
    let grid = expected.drawn.grid;
    // Packed samples outside the image have undefined values.
    let is_drawn = |x, y| {
        let (x, y) = grid.pixel(x, y);
        x < expected.raster.width && y < expected.raster.height
    };
    first_of(ComparedQuantity::Color, [&expected.drawn.color, &found.drawn.color], is_drawn, |a, b| a == b)
        .or_else(|| match [&expected.drawn.depth, &found.drawn.depth] {
            [Some(expected), Some(found)] => {
                first_of(ComparedQuantity::Depth, [expected, found], is_drawn, |a, b| a.to_bits() == b.to_bits())
            }
            [None, None] => None,
            depths => Some(FrameDifference::as_a_whole(
                ComparedQuantity::Depth,
                depths.map(|depth| match depth {
                    Some(depth) => size_in_words(depth),
                    None => "none".to_owned(),
                }),
            )),
        })
        .or_else(|| first_of(ComparedQuantity::Picture, [expected.image(), found.image()], |_, _| true, |a, b| a == b))
}

fn size_in_words<T: Copy>(image: &Image<T>) -> String {
    let (width, height) = image.size();
    format!("{width} × {height}")
}

fn first_of<T: Copy + std::fmt::Debug>(
    quantity: ComparedQuantity,
    [expected, found]: [&Image<T>; 2],
    counts: impl Fn(u32, u32) -> bool,
    same: impl Fn(&T, &T) -> bool,
) -> Option<FrameDifference> {
    if expected.size() != found.size() {
        return Some(FrameDifference::as_a_whole(quantity, [size_in_words(expected), size_in_words(found)]));
    }
    let (width, height) = expected.size();
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let mut differing = places.filter(|(x, y)| counts(*x, *y) && !same(&expected.at(*x, *y), &found.at(*x, *y)));
    let first @ (x, y) = differing.next()?;
    let [expected, found] = [expected, found].map(|image| format!("{:?}", image.at(x, y)));
    Some(FrameDifference { quantity, samples: 1 + differing.count(), first, expected, found })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin;

    const SIZE: Viewport = Viewport { width: 64, height: 48 };

    fn drawn(settings: &str) -> Frame {
        let scene = Arc::new(builtin::by_id("triangle").unwrap().build());
        let mut recipe = Recipe::default();
        recipe.set(settings).unwrap();
        Renderer::default().render(
            RenderInputs { scene: &scene, camera: &scene.home, recipe: &recipe, viewport: SIZE },
            KeepDepth::Yes,
        )
    }

    #[test]
    fn every_kind_of_lanes_and_every_number_of_threads_is_compared() {
        let scene = Arc::new(builtin::by_id("near-plane").unwrap().build());
        let mut recipe = Recipe::default();
        for setting in ["upscaler.method=checkerboard", "antialias.method=multisample", "antialias.method=jittered"] {
            recipe.set(setting).unwrap();
            let several_tiles = Viewport { width: 150, height: 70 };
            let found = verify(&scene, &scene.home, &recipe, several_tiles, &[1, 3]).unwrap();
            assert_eq!((found.ways.len(), found.obstacle), (2 * Lanes::all().count(), None));
            assert!(found.ways.iter().all(|way| way.difference.is_none()), "{found:?}");
        }
        recipe.set("arithmetic=f32").unwrap();
        let found = verify(&scene, &scene.home, &recipe, SIZE, &[1]).unwrap();
        assert!(found.ways.is_empty() && found.obstacle.is_some());
    }

    #[test]
    fn the_first_difference_is_named_and_all_are_counted() {
        let right = drawn("shading=vertex-color");
        assert_eq!(difference(&right, &right), None);
        let mut wrong = right.clone();
        wrong.drawn.color.set(63, 47, [1, 2, 3, 4]);
        wrong.drawn.color.set(5, 9, [1, 2, 3, 4]);
        let reported = difference(&right, &wrong).unwrap();
        assert_eq!((reported.quantity, reported.samples, reported.first), (ComparedQuantity::Color, 2, (5, 9)));
        assert_eq!(reported.found, "[1, 2, 3, 4]");

        let mut deeper = right.clone();
        let depth = deeper.drawn.depth.as_mut().unwrap();
        depth.set(0, 0, f32::from_bits(depth.at(0, 0).to_bits() ^ 1));
        let reported = difference(&right, &deeper).unwrap();
        assert_eq!((reported.quantity, reported.samples, reported.first), (ComparedQuantity::Depth, 1, (0, 0)));

        let filtered = drawn("post.filter=blur");
        let unfiltered = drawn("post.filter=none");
        assert_eq!(difference(&unfiltered, &filtered).unwrap().quantity, ComparedQuantity::Picture);
    }
}
