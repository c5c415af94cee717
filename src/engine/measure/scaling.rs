//! Scaling of frame cost with the number of triangles, pixels, layers of overdraw and threads.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::ThreadPool;
use serde::Serialize;
use thiserror::Error;

use super::timing::{Summary, summarize};
use crate::chain::{KeepDepth, Recipe, RenderInputs, Renderer};
use crate::pipeline::viewport::Viewport;
use crate::scene::Scene;
use crate::scene::builtin::workload::{layers, sheet};

/// Quantity that varies between the points of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScalingQuantity {
    /// Triangles of a mesh that fills most of the image.
    Triangles,
    /// Pixels of an image filled by one textured square.
    Pixels,
    /// Overlapping squares, drawn back to front.
    Layers,
    /// Threads that draw the mesh.
    Threads,
}

impl ScalingQuantity {
    /// All quantities, in the order of the report.
    pub(crate) const ALL: [Self; 4] = [Self::Triangles, Self::Pixels, Self::Layers, Self::Threads];

    /// Returns the display name of the varied quantity.
    pub fn name(self) -> &'static str {
        match self {
            Self::Triangles => "triangles",
            Self::Pixels => "pixels",
            Self::Layers => "layers",
            Self::Threads => "threads",
        }
    }
}

/// Parameters of a scaling measurement.
#[derive(Clone, Debug)]
pub struct ScalingPlan {
    /// Recipe that draws all frames.
    pub(crate) recipe: Recipe,
    /// Image size for all series except the series over pixels.
    pub(crate) viewport: Viewport,
    /// Triangle counts of the series over triangles.
    pub(crate) triangles: Vec<usize>,
    /// Image sizes of the series over pixels.
    pub(crate) sizes: Vec<Viewport>,
    /// Layer counts of the series over layers.
    pub(crate) layers: Vec<usize>,
    /// Thread counts to measure; the last one also applies to all other series.
    pub(crate) threads: Vec<usize>,
    /// Number of triangles in the mesh of the series over threads.
    pub(crate) shared_triangles: usize,
    /// Number of measured rounds.
    pub(crate) rounds: usize,
}

impl ScalingPlan {
    /// Creates the default plan: 10³ to `most_triangles` triangles in powers of ten, 320 × 180 to 3840 × 2160 pixels, 1
    /// to 64 layers, and 1, 2, 4 … threads up to `threads` ≥ 1.
    pub fn new(recipe: Recipe, most_triangles: usize, threads: usize, rounds: usize) -> Self {
        let powers = (3..=9).map(|power| 10_usize.pow(power)).take_while(|n| *n <= most_triangles);
        let size = |(width, height)| Viewport { width, height };
        let sizes = [(320, 180), (640, 360), (1280, 720), (1920, 1080), (2560, 1440), (3840, 2160)];
        Self {
            recipe,
            viewport: size((1280, 720)),
            triangles: powers.collect(),
            sizes: sizes.map(size).into(),
            layers: (0..=6).map(|power| 1 << power).collect(),
            threads: (0..).map(|power| 1 << power).take_while(|n| *n < threads).chain([threads.max(1)]).collect(),
            shared_triangles: 100_000,
            rounds,
        }
    }
}

/// Cost of a frame at one value of the varied quantity.
#[derive(Clone, Debug, Serialize)]
pub struct ScalingPoint {
    /// Value of the varied quantity.
    pub value: f64,
    /// Frame times, in milliseconds.
    pub ms: Summary,
    /// Memory used by the frame, the renderer's buffers, meshes and textures, in bytes.
    pub(crate) bytes: usize,
}

/// Cost of a frame as a function of one quantity.
#[derive(Clone, Debug, Serialize)]
pub struct Series {
    /// Varied quantity.
    pub quantity: ScalingQuantity,
    /// Measured points, in ascending order of the varied quantity.
    pub points: Vec<ScalingPoint>,
}

/// Linear model of frame cost: a fixed part plus a part proportional to the varied quantity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct CostLine {
    /// Intercept, in milliseconds; negative if cost grows faster than the varied quantity.
    pub(crate) fixed_ms: f64,
    /// Slope, in nanoseconds per unit of the varied quantity.
    pub(crate) ns_each: f64,
}

impl CostLine {
    /// Returns the value of the varied quantity at which the fixed and proportional parts are equal. Below it, cost
    /// hardly depends on the quantity; above it, cost is nearly proportional to it.
    pub(crate) fn bend(&self) -> f64 {
        self.fixed_ms * 1e6 / self.ns_each
    }
}

impl Series {
    /// Returns the line through the first and last points, or `None` if cost does not rise.
    pub(crate) fn line(&self) -> Option<CostLine> {
        let (first, last) = (self.points.first()?, self.points.last()?);
        let ms_each = (last.ms.median - first.ms.median) / (last.value - first.value);
        let fixed_ms = first.ms.median - ms_each * first.value;
        (ms_each > 0.0 && ms_each.is_finite()).then_some(CostLine { fixed_ms, ns_each: ms_each * 1e6 })
    }
}

/// Result of a scaling measurement.
#[derive(Clone, Debug, Serialize)]
pub struct Scaling {
    /// Image width and height in pixels, for all series except the series over pixels.
    pub size: [u32; 2],
    /// Number of threads, for all series except the series over threads.
    pub threads: usize,
    /// Number of measured rounds.
    pub rounds: usize,
    /// One series for each quantity.
    pub series: Vec<Series>,
    /// Whether the measurement was cancelled before all series were complete.
    pub partial: bool,
}

/// Reason why a measurement has no result.
#[derive(Debug, Error)]
pub enum ScalingError {
    /// The measurement was cancelled.
    #[error("the measurement was cancelled")]
    Cancelled,
    /// The system could not start threads.
    #[error("cannot start the threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Point of a series while it is being measured.
struct ScalingRun<'a> {
    value: f64,
    scene: Arc<Scene>,
    viewport: Viewport,
    pool: &'a ThreadPool,
    renderer: Renderer,
    ms: Vec<f64>,
    bytes: usize,
}

/// Measures all series. Each round draws every point of a series once; the first round is warm-up. `progress` receives
/// the current quantity and its completed fraction in [0, 1].
///
/// # Errors
///
/// Fails if threads cannot be started, or if cancelled before the first series is complete. If cancelled later, returns
/// the complete series.
pub fn measure(
    plan: &ScalingPlan,
    progress: &dyn Fn(ScalingQuantity, f32),
    cancel: &AtomicBool,
) -> Result<Scaling, ScalingError> {
    let pool = |threads: &usize| rayon::ThreadPoolBuilder::new().num_threads(*threads).build();
    let mut series = Vec::new();
    let found = |series, partial| Scaling {
        size: [plan.viewport.width, plan.viewport.height],
        threads: plan.threads.last().copied().unwrap_or(1),
        rounds: plan.rounds,
        series,
        partial,
    };
    for quantity in ScalingQuantity::ALL {
        let counts = match quantity {
            ScalingQuantity::Threads => &plan.threads[..],
            _ => &plan.threads[plan.threads.len().saturating_sub(1)..],
        };
        let pools = counts.iter().map(pool).collect::<Result<Vec<_>, _>>()?;
        let mut runs = runs(plan, quantity, &pools);
        for round in 0..=plan.rounds {
            for run in &mut runs {
                if cancel.load(Ordering::Relaxed) {
                    return if series.is_empty() { Err(ScalingError::Cancelled) } else { Ok(found(series, true)) };
                }
                let ms = run.draw(&plan.recipe);
                if round > 0 {
                    run.ms.push(ms);
                }
            }
            progress(quantity, (round + 1) as f32 / (plan.rounds + 1) as f32);
        }
        let point =
            |run: ScalingRun<'_>| Some(ScalingPoint { value: run.value, ms: summarize(&run.ms)?, bytes: run.bytes });
        series.push(Series { quantity, points: runs.into_iter().filter_map(point).collect() });
    }
    Ok(found(series, false))
}

fn runs<'a>(plan: &ScalingPlan, quantity: ScalingQuantity, pools: &'a [ThreadPool]) -> Vec<ScalingRun<'a>> {
    let Some(most) = pools.last() else { return Vec::new() };
    let run = |value: f64, scene: Arc<Scene>, viewport: Viewport, pool: &'a ThreadPool| ScalingRun {
        value,
        scene,
        viewport,
        pool,
        renderer: Renderer::default(),
        ms: Vec::with_capacity(plan.rounds),
        bytes: 0,
    };
    match quantity {
        ScalingQuantity::Triangles => plan
            .triangles
            .iter()
            .map(|count| {
                let scene = sheet(*count);
                run(scene.triangle_count() as f64, scene.into(), plan.viewport, most)
            })
            .collect(),
        ScalingQuantity::Pixels => {
            let scene = Arc::new(layers(1));
            let pixels = |size: &Viewport| f64::from(size.width) * f64::from(size.height);
            plan.sizes.iter().map(|size| run(pixels(size), scene.clone(), *size, most)).collect()
        }
        ScalingQuantity::Layers => {
            plan.layers.iter().map(|count| run(*count as f64, layers(*count).into(), plan.viewport, most)).collect()
        }
        ScalingQuantity::Threads => {
            let scene = Arc::new(sheet(plan.shared_triangles));
            let threads = plan.threads.iter().zip(pools);
            threads.map(|(count, pool)| run(*count as f64, scene.clone(), plan.viewport, pool)).collect()
        }
    }
}

impl ScalingRun<'_> {
    /// Draws a frame and returns its time in milliseconds.
    fn draw(&mut self, recipe: &Recipe) -> f64 {
        let Self { scene, viewport, pool, renderer, bytes, .. } = self;
        let frame = pool.install(|| {
            renderer.render(RenderInputs { scene, camera: &scene.home, recipe, viewport: *viewport }, KeepDepth::No)
        });
        let ms = frame.times.total.as_secs_f64() * 1e3;
        *bytes = frame.image().bytes() + renderer.bytes() + scene.memory().shared_bytes;
        renderer.recycle(frame);
        ms
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> ScalingPlan {
        let size = |width, height| Viewport { width, height };
        ScalingPlan {
            triangles: vec![10, 1000],
            sizes: vec![size(16, 9), size(64, 36)],
            layers: vec![1, 3],
            shared_triangles: 100,
            viewport: size(64, 36),
            ..ScalingPlan::new(Recipe::default(), 1000, 2, 2)
        }
    }

    const SIZE: Viewport = Viewport { width: 160, height: 90 };

    fn drawn(scene: Scene) -> crate::chain::Frame {
        let home = scene.home;
        Renderer::default().render(
            RenderInputs { scene: &Arc::new(scene), camera: &home, recipe: &Recipe::default(), viewport: SIZE },
            KeepDepth::No,
        )
    }

    #[test]
    fn every_triangle_of_a_sheet_faces_the_viewer_and_is_in_view() {
        for (asked, given) in [(1, 2), (1000, 968), (20_000, 20_000)] {
            let counts = drawn(sheet(asked)).tiled.unwrap().counts;
            assert_eq!((counts.triangles_in, counts.rasterized), (given, given));
        }
    }

    #[test]
    fn layers_fill_the_picture_and_the_nearest_hides_the_others() {
        let (one, seven) = (drawn(layers(1)), drawn(layers(7)));
        assert_eq!(seven.tiled.as_ref().unwrap().counts.shaded, 160 * 90);
        assert_eq!(one.image(), seven.image(), "the nearest lies where the only one lay");
        assert!(one.image().pixels().iter().all(|pixel| *pixel != [30, 32, 36, 255]));
    }

    #[test]
    fn every_quantity_is_measured_at_every_value() {
        let found = measure(&small(), &|_, _| {}, &AtomicBool::new(false)).unwrap();
        let values: Vec<Vec<f64>> =
            found.series.iter().map(|series| series.points.iter().map(|point| point.value).collect()).collect();
        assert_eq!(values, [[8.0, 968.0], [144.0, 2304.0], [1.0, 3.0], [1.0, 2.0]]);
        let points = || found.series.iter().flat_map(|series| &series.points);
        assert!(points().all(|point| point.ms.n == 2 && point.ms.median > 0.0 && point.bytes > 0));
        assert!(!found.partial);
        assert!(matches!(measure(&small(), &|_, _| {}, &AtomicBool::new(true)), Err(ScalingError::Cancelled)));
        let cancel = AtomicBool::new(false);
        let cancel_later = |quantity, _| cancel.store(quantity == ScalingQuantity::ALL[1], Ordering::Relaxed);
        let partial = measure(&small(), &cancel_later, &cancel).unwrap();
        assert_eq!((partial.partial, partial.series.len()), (true, 1), "the complete series, marked");
    }

    #[test]
    fn the_fixed_part_and_the_growing_one_are_told_apart() {
        let point = |value: f64, ms: f64| ScalingPoint { value, ms: summarize(&[ms]).unwrap(), bytes: 0 };
        let series = |points| Series { quantity: ScalingQuantity::Pixels, points };
        let line = series(vec![point(1000.0, 3.0), point(2000.0, 3.9), point(5000.0, 7.0)]).line().unwrap();
        assert_eq!((line.fixed_ms, line.ns_each, line.bend()), (2.0, 1000.0, 2000.0));
        assert_eq!(series(vec![point(1.0, 3.0), point(2.0, 2.0)]).line(), None);
        assert_eq!(series(vec![point(1.0, 3.0)]).line(), None);
    }

    #[test]
    fn the_plan_goes_up_to_the_requested_maximum() {
        let plan = ScalingPlan::new(Recipe::default(), 10_000_000, 3, 5);
        assert_eq!(plan.triangles, [1000, 10_000, 100_000, 1_000_000, 10_000_000]);
        assert_eq!((plan.threads, plan.layers.last()), (vec![1, 2, 3], Some(&64)));
        let threads = |most| ScalingPlan::new(Recipe::default(), 1000, most, 1).threads;
        assert_eq!((threads(1), threads(16)), (vec![1], vec![1, 2, 4, 8, 16]));
        assert!(threads(1024).iter().sum::<usize>() < 2 * 1024, "not one more for each");
    }
}
