//! Errors of upscalers over the frames of a clip: against the converged reference of the same frame, over time, and in
//! disoccluded pixels.
//!
//! All methods draw a frame before the next one is drawn, so that their times are interleaved. Methods with history also
//! draw [`Turn::WARM_UP`] frames before the clip, which are not measured. The exact motion and disocclusion of the
//! reference decide which pixels are compared over time; see [`crate::measure::temporal`].

mod page;

mod sheet;

use std::io;
use std::sync::Arc;

use serde::Serialize;

use crate::chain::{Frame, FrameView, KeepDepth, MotionBuffers, Recipe, RenderInputs, Renderer};
use crate::image::{Image, Rgba8};
use crate::inspect::temporal::MaskScore;
use crate::measure::against::{ErrorMetrics, PreparedReference};
use crate::measure::jod::{SequenceJod, Viewing};
use crate::measure::machine::Machine;
use crate::measure::motion::{MotionError, Turn};
use crate::measure::noise::{Noise, Pairs};
use crate::measure::reference::ProgressiveRender;
use crate::measure::shot::Shot;
use crate::measure::temporal::MotionField;
use crate::measure::temporal::flicker::{Flicker, FramePair};
use crate::measure::temporal::ghosting::{Ghosting, Visibility};
use crate::measure::temporal::lag::Lag;
use crate::measure::timing::{Summary, summarize};
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, Scene};
use crate::upscale::Upscaling;
use sheet::{FrameSheet, SheetRow};

/// Number of frames after a disocclusion in which an error counts as ghosting.
pub const GHOST_FRAMES: u32 = 4;

/// Maximum number of pixels per frame and method whose rejection is compared with the disocclusion: each is computed
/// alone.
const REJECTION_PIXELS: u32 = 1 << 14;

/// Scene, settings and methods of a measurement.
#[derive(Clone, Debug)]
pub struct MotionPlan {
    /// Scene and camera of every frame.
    pub shot: Shot,
    /// Settings of all methods, apart from the upscaler.
    pub recipe: Recipe,
    /// Upscalers that are measured, each with its scale and options.
    pub upscalers: Vec<Upscaling>,
    /// Size of every frame, in pixels.
    pub viewport: Viewport,
    /// Number of frames, at least 2.
    pub frames: u32,
    /// Number of samples per pixel of the references.
    pub samples: u32,
    /// Pixels per degree of visual angle, for ColorVideoVDP.
    pub pixels_per_degree: f64,
    /// Whether to keep small pictures of every method and frame for the page.
    pub keeps_pictures: bool,
}

/// Errors and times of all methods over a clip.
#[derive(Debug, Serialize)]
pub struct MotionReport {
    /// Display name of the scene.
    pub scene: String,
    /// Width and height of every frame, in pixels.
    pub size_px: [u32; 2],
    /// Number of measured frames.
    pub frames: u32,
    /// Number of frames per second.
    pub frames_per_second: f64,
    /// Number of samples per pixel of the references.
    pub samples_per_pixel: u32,
    /// Pixels per degree of visual angle.
    pub pixels_per_degree: f64,
    /// Fraction of the pixels that are disoccluded, mean over the frames, in [0, 1].
    pub disoccluded_share: f64,
    /// Noise floor of the times, from neighbouring frames of the same method; `None` if there are too few.
    pub noise: Option<Noise>,
    /// Processor, threads and load of the machine during the measurement.
    pub machine: Machine,
    /// Results of each method, in the order of the plan.
    pub methods: Vec<MethodInMotion>,
    /// Whether the measurement was cancelled before the last frame.
    pub partial: bool,
    /// Contact sheets of the frames, if the plan keeps pictures.
    #[serde(skip)]
    sheets: Vec<FrameSheet>,
}

/// Errors and times of one method over a clip.
#[derive(Debug, Serialize)]
pub struct MethodInMotion {
    /// Display name of the upscaler with its scale and options.
    pub label: String,
    /// Method with its options.
    pub upscaler: Upscaling,
    /// Times of the frames, in milliseconds.
    pub frame_ms: Summary,
    /// Quality of the clip in just-objectionable differences, 10 for no visible difference; `None` if the frames are too
    /// small or too large.
    pub jod: Option<f64>,
    /// Mean and worst error over the frames.
    pub error: MotionError,
    /// Flicker; `None` if no surface is visible in two frames.
    pub flicker: Option<Flicker>,
    /// Ghosting; `None` if no surface is disoccluded.
    pub ghosting: Option<Ghosting>,
    /// Frames by which the picture is behind its reference; `None` if nothing moves.
    pub lag: Option<Lag>,
    /// Agreement of the pixels whose history was rejected with the exact disocclusion; `None` without history.
    pub rejection: Option<RejectionScore>,
    /// Error of each frame.
    pub errors: Vec<ErrorMetrics>,
}

/// Agreement of the pixels whose history a method rejected with the exact disocclusion, over all frames.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RejectionScore {
    /// Fraction of the rejected pixels that are disoccluded, in [0, 1]; `None` if none is rejected.
    pub precision: Option<f64>,
    /// Fraction of the disoccluded pixels that are rejected, in [0, 1]; `None` without disocclusion.
    pub recall: Option<f64>,
}

impl RejectionScore {
    /// Combines the scores of single frames. Returns `None` for an empty slice.
    fn over(frames: &[MaskScore]) -> Option<Self> {
        let all = frames.iter().copied().reduce(MaskScore::and)?;
        Some(Self { precision: all.precision(), recall: all.recall() })
    }
}

/// Progress of a measurement: frames drawn, and frames in total, both including warm-up frames.
pub type Progress<'a> = &'a mut dyn FnMut(u32, u32) -> bool;

/// Measures a clip. `go_on` receives the number of drawn frames and their total, and returns whether to continue. Returns
/// `None` if cancelled before two frames were measured.
///
/// # Errors
/// Returns an error if a picture of the page cannot be encoded.
pub fn measure(plan: &MotionPlan, go_on: Progress<'_>) -> io::Result<Option<MotionReport>> {
    let machine = Machine::at_start();
    let viewing = Viewing { pixels_per_degree: plan.pixels_per_degree, frames_per_second: plan.shot.frames_per_second };
    let mut methods: Vec<_> = plan.upscalers.iter().map(|upscaler| Method::new(plan, *upscaler, viewing)).collect();
    let total = plan.frames + Turn::WARM_UP;
    let mut before: Option<FrameReference> = None;
    let (mut measured, mut disoccluded_share, mut sheets) = (0, 0.0, Vec::new());
    for number in -i64::from(Turn::WARM_UP)..i64::from(plan.frames) {
        if !go_on((number + i64::from(Turn::WARM_UP)) as u32, total) {
            break;
        }
        let (scene, camera) = plan.shot.view(number);
        if number < 0 {
            methods.iter_mut().filter(|method| method.reads_history).for_each(|method| {
                let frame = method.draw(&scene, &camera, plan.viewport);
                method.renderer.recycle(frame);
            });
            continue;
        }
        let reference = FrameReference::new(plan, scene, camera, before.as_ref());
        disoccluded_share += reference.disoccluded_share();
        let mut rows = plan.has_sheet(measured).then(|| vec![reference.row()]);
        for method in &mut methods {
            let picture = method.picture(&reference, plan.viewport);
            let Some(flip) = method.judge(&picture, &reference, before.as_ref()) else { return Ok(None) };
            if let Some(rows) = &mut rows {
                rows.push(SheetRow::of_method(&picture, &flip));
            }
            method.before = Some(picture);
        }
        if let Some(rows) = rows {
            sheets.push(FrameSheet::new(measured, &rows, sheet::bytes_per_sheet(plan.frames))?);
        }
        before = Some(reference);
        measured += 1;
    }
    if measured < 2 {
        return Ok(None);
    }
    Ok(Some(MotionReport {
        scene: plan.shot.scene.name.clone(),
        size_px: [plan.viewport.width, plan.viewport.height],
        frames: measured,
        frames_per_second: plan.shot.frames_per_second,
        samples_per_pixel: plan.samples,
        pixels_per_degree: plan.pixels_per_degree,
        disoccluded_share: disoccluded_share / f64::from(measured - 1),
        noise: noise(&methods),
        machine: machine.at_end(),
        methods: methods.into_iter().filter_map(Method::finish).collect(),
        partial: measured < plan.frames,
        sheets,
    }))
}

/// Returns the noise floor of the times of all methods.
fn noise(methods: &[Method]) -> Option<Noise> {
    let mut pairs = Pairs::default();
    methods.iter().for_each(|method| pairs.add_alternating(method.measured_ms()));
    pairs.noise()
}

impl MotionPlan {
    /// Whether the page has pictures of a frame.
    fn has_sheet(&self, frame: u32) -> bool {
        self.keeps_pictures && frame.is_multiple_of(sheet::step(self.frames))
    }
}

/// Reference of a frame, and its motion since the preceding frame.
struct FrameReference {
    scene: Arc<Scene>,
    camera: Camera,
    picture: Image<Rgba8>,
    prepared: PreparedReference,
    /// Motion since the preceding frame; `None` in the first frame.
    motion: Option<MotionField>,
    visibility: Visibility,
}

impl FrameReference {
    fn new(plan: &MotionPlan, scene: Arc<Scene>, camera: Camera, before: Option<&Self>) -> Self {
        let mut render = ProgressiveRender::new(&scene, &camera, &plan.recipe, plan.viewport, plan.samples);
        while render.step() {}
        let picture = render.picture();
        let (width, height) = picture.size();
        let motion = before.and_then(|before| {
            let [now, then] =
                [(&scene, &camera), (&before.scene, &before.camera)].map(|(scene, camera)| FrameView { scene, camera });
            let buffers = MotionBuffers::between(now, then, &plan.recipe, plan.viewport)?;
            Some(Image::from_fn(width, height, |x, y| match buffers.is_disoccluded(x, y) {
                true => [f32::NAN; 2],
                false => {
                    let [across_px, down_px] = buffers.vector_px(x, y);
                    [x as f32 + 0.5 + across_px, y as f32 + 0.5 + down_px]
                }
            }))
        });
        let first = || Visibility::first(width, height);
        let next = before.zip(motion.as_ref()).and_then(|(before, motion)| before.visibility.next(motion));
        Self {
            prepared: PreparedReference::new(picture.clone()),
            visibility: next.unwrap_or_else(first),
            scene,
            camera,
            picture,
            motion,
        }
    }

    /// Returns the row of the contact sheet.
    fn row(&self) -> SheetRow {
        SheetRow::of_reference(&self.picture, |x, y| self.is_disoccluded((x, y)))
    }

    /// Whether the preceding frame does not show the surface of a pixel.
    fn is_disoccluded(&self, (x, y): (u32, u32)) -> bool {
        self.motion.as_ref().is_some_and(|motion| motion.at(x, y)[0].is_nan())
    }

    fn disoccluded_share(&self) -> f64 {
        let Some(motion) = &self.motion else { return 0.0 };
        let disoccluded = motion.pixels().iter().filter(|[x, _]| x.is_nan()).count();
        disoccluded as f64 / motion.pixels().len() as f64
    }
}

/// Method that is being measured.
struct Method {
    recipe: Recipe,
    reads_history: bool,
    renderer: Renderer,
    before: Option<Image<Rgba8>>,
    jod: Option<SequenceJod>,
    times_ms: Vec<f64>,
    errors: Vec<ErrorMetrics>,
    flicker: Vec<Flicker>,
    ghosting: Vec<Ghosting>,
    lag: Vec<Lag>,
    rejection: Vec<MaskScore>,
}

impl Method {
    fn new(plan: &MotionPlan, upscaler: Upscaling, viewing: Viewing) -> Self {
        Self {
            recipe: Recipe { upscaler, ..plan.recipe },
            reads_history: upscaler.upscaler().reads().history,
            renderer: Renderer::default(),
            before: None,
            jod: SequenceJod::new(viewing),
            times_ms: Vec::new(),
            errors: Vec::new(),
            flicker: Vec::new(),
            ghosting: Vec::new(),
            lag: Vec::new(),
            rejection: Vec::new(),
        }
    }

    /// Draws the next frame.
    fn draw(&mut self, scene: &Arc<Scene>, camera: &Camera, viewport: Viewport) -> Frame {
        let frame = self.renderer.render(RenderInputs { scene, camera, recipe: &self.recipe, viewport }, KeepDepth::No);
        self.times_ms.push(frame.times.total.as_secs_f64() * 1e3);
        frame
    }

    /// Draws the next measured frame and returns its picture.
    fn picture(&mut self, reference: &FrameReference, viewport: Viewport) -> Image<Rgba8> {
        let frame = self.draw(&reference.scene, &reference.camera, viewport);
        if reference.motion.is_some() {
            let is_disoccluded = |at| reference.is_disoccluded(at);
            self.rejection.extend(MaskScore::of_rejection(&self.recipe, &frame, is_disoccluded, REJECTION_PIXELS));
        }
        let picture = frame.image().clone();
        self.renderer.recycle(frame);
        picture
    }

    /// Compares a picture with the reference of its frame, and returns the FLIP error of every pixel. Returns `None` if
    /// the sizes differ.
    fn judge(
        &mut self,
        picture: &Image<Rgba8>,
        reference: &FrameReference,
        before: Option<&FrameReference>,
    ) -> Option<Image<f32>> {
        let (metrics, flip) = reference.prepared.figures(picture)?;
        self.errors.push(metrics);
        self.jod = self.jod.take().and_then(|mut jod| jod.add(picture, &reference.picture).map(|()| jod));
        if let (Some(motion), Some(before), Some(picture_before)) = (&reference.motion, before, &self.before) {
            let frames =
                FramePair { picture, picture_before, reference: &reference.picture, reference_before: &before.picture };
            self.flicker.extend(Flicker::of(&frames, motion));
            self.ghosting.extend(Ghosting::of(&flip, &reference.visibility.recently_disoccluded(GHOST_FRAMES)));
            self.lag.extend(Lag::of(picture, &reference.picture, motion));
        }
        Some(flip)
    }

    /// Returns the times of the measured frames in milliseconds, without those of warm-up frames.
    fn measured_ms(&self) -> &[f64] {
        &self.times_ms[self.times_ms.len().saturating_sub(self.errors.len())..]
    }

    fn finish(self) -> Option<MethodInMotion> {
        let frame_ms = summarize(self.measured_ms())?;
        Some(MethodInMotion {
            label: self.recipe.upscaler.label(),
            upscaler: self.recipe.upscaler,
            frame_ms,
            jod: self.jod.and_then(SequenceJod::finish),
            error: MotionError::of(&self.errors)?,
            flicker: Flicker::over(&self.flicker),
            ghosting: Ghosting::over(&self.ghosting),
            lag: Lag::over(&self.lag),
            rejection: RejectionScore::over(&self.rejection),
            errors: self.errors,
        })
    }
}

impl MotionReport {
    /// Names of the columns of [`Self::rows`].
    pub const HEADS: [&'static str; 13] = [
        "method",
        "ms, median",
        "ms, p10–p90",
        "JOD",
        "PSNR, dB",
        "SSIM",
        "FLIP, mean",
        "FLIP, worst",
        "flicker",
        "ghosting",
        "lag, frames",
        "rejection, precision",
        "rejection, recall",
    ];

    /// Returns the cells of the table, one row per method, in the order of the plan.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let optional = |value: Option<f64>, digits: usize| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{value:.digits$}"))
        };
        let row = |method: &MethodInMotion| {
            vec![
                method.label.clone(),
                format!("{:.2}", method.frame_ms.median),
                format!("{:.2}–{:.2}", method.frame_ms.p10, method.frame_ms.p90),
                optional(method.jod, 3),
                format!("{:.2}", method.error.mean.codes.psnr_db),
                format!("{:.4}", method.error.mean.codes.ssim),
                format!("{:.4}", method.error.mean.flip),
                format!("{:.4}", method.error.worst.flip),
                optional(method.flicker.map(|flicker| flicker.flicker), 3),
                optional(method.ghosting.map(|ghosting| ghosting.ghosting), 4),
                optional(method.lag.map(|lag| lag.frames), 2),
                optional(method.rejection.and_then(|score| score.precision), 3),
                optional(method.rejection.and_then(|score| score.recall), 3),
            ]
        };
        self.methods.iter().map(row).collect()
    }

    /// Returns the report as an HTML page. `command` describes how it was made.
    pub fn html(&self, command: &str) -> String {
        page::html(self, command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::shot::CameraMotion;
    use crate::report::html::MAX_PAGE_BYTES;
    use crate::scene::builtin;

    fn report(scene: &str, upscalers: &[(&str, u32)]) -> MotionReport {
        let scene = Arc::new(builtin::by_id(scene).unwrap().build());
        let plan = MotionPlan {
            shot: Shot::from_start(Arc::clone(&scene), scene.home, CameraMotion::Still, 30.0),
            recipe: Recipe::default(),
            upscalers: upscalers.iter().map(|(method, scale)| Upscaling::new(method, *scale).unwrap()).collect(),
            viewport: Viewport { width: 96, height: 54 },
            frames: 3,
            samples: 8,
            pixels_per_degree: 67.0,
            keeps_pictures: true,
        };
        measure(&plan, &mut |_, _| true).unwrap().unwrap()
    }

    #[test]
    fn every_metric_is_measured_where_something_moves() {
        let report = report("chess-motion", &[("native", 1), ("taa", 1), ("nearest", 4)]);
        assert_eq!((report.frames, report.partial, report.methods.len()), (3, false, 3));
        for method in &report.methods {
            assert_eq!(method.errors.len(), 3, "{}", method.label);
            assert_eq!(method.frame_ms.n, 3, "warm-up frames are not timed: {}", method.label);
            assert!(method.jod.is_some() && method.flicker.is_some() && method.ghosting.is_some(), "{}", method.label);
        }
        let [native, taa, nearest] = [0, 1, 2].map(|index| &report.methods[index]);
        assert!(nearest.error.mean.flip > 2.0 * native.error.mean.flip);
        assert!(nearest.jod < native.jod && nearest.jod < taa.jod);
        assert!(report.disoccluded_share > 0.0 && report.disoccluded_share < 0.2, "{}", report.disoccluded_share);
        assert_eq!(report.rows()[0].len(), MotionReport::HEADS.len());
        assert!(report.noise.is_some());
        assert!(native.rejection.is_none() && nearest.rejection.is_none());
        // The counts are checked in `inspect::temporal`.
        assert!(taa.rejection.is_some_and(|score| score.precision.is_some() && score.recall.is_some()));
    }

    #[test]
    fn the_page_has_the_pictures_of_every_frame_and_loads_nothing() {
        let report = report("chess-motion", &[("native", 1), ("taa", 1)]);
        let html = report.html("command");
        assert!(html.len() <= MAX_PAGE_BYTES && !html.contains("<script"), "{}", html.len());
        for frame in 0..3 {
            assert!(
                html.contains(&format!("id=\"frame-{frame}\" style=\"--sheet: url(data:image/jpeg")),
                "frame {frame}"
            );
            assert!(html.contains(&format!("href=\"#frame-{frame}\"")), "a link to frame {frame}");
        }
        assert_eq!(html.matches("data:image/jpeg").count(), 3, "one sheet per frame");
        assert_eq!(html.matches("class=\"strip\"").count(), 3 * 3, "reference and two methods");
        assert!(!html.contains("://"), "no address of another file");
    }

    #[test]
    fn a_still_scene_has_no_disocclusion_and_no_lag() {
        let report = report("triangle", &[("native", 1)]);
        assert_eq!(report.disoccluded_share, 0.0);
        assert!(report.methods[0].ghosting.is_none() && report.methods[0].lag.is_none());
    }
}
