//! Trace of the motion vector of a pixel: the corners of its triangle in both frames, their positions in pixels, and the
//! vector, with the arithmetic of the motion buffers.

use glam::{DMat4, DVec3, DVec4};

use super::formula::{Formula, fraction, given, whole};
use super::line::{TraceRecorder, TraceStage};
use super::subject::TracedFragment;
use crate::chain::Recipe;
use crate::inspect::FragmentOutcome;
use crate::pipeline::motion::{BLOCK, MovedTriangle, PlaneMotion, px_from_world};
use crate::pipeline::settings::DepthTest;
use crate::pipeline::viewport::Viewport;
use crate::scene::{Camera, DepthMapping, Instance, Mesh};

/// Triangle in one frame.
struct PlacedTriangle {
    /// Corners in clip space.
    clip: [DVec4; 3],
    /// Corners in homogeneous pixels: x · w, y · w and w.
    px: [DVec3; 3],
    /// Transform from model space to homogeneous pixels.
    px_from_model: DMat4,
}

impl PlacedTriangle {
    fn new(subject: &TracedFragment<'_>, camera: &Camera, instance: &Instance, mesh: &Mesh) -> Option<Self> {
        let Viewport { width, height } = subject.raster;
        let clip_from_world = camera.clip_from_world_f64(subject.raster.aspect(), DepthMapping::STANDARD);
        let world_from_model = instance.world_from_model.as_dmat4();
        let clip_from_model = clip_from_world * world_from_model;
        let px_from_model = px_from_world(camera, (width, height)) * world_from_model;
        let [a, b, c] = subject.corners.map(|corner| mesh.positions.get(corner));
        let corners = [a?, b?, c?].map(|position| position.as_dvec3().extend(1.0));
        let clip = corners.map(|corner| clip_from_model * corner);
        Some(Self { clip, px: corners.map(|corner| (px_from_model * corner).truncate()), px_from_model })
    }
}

/// Writes the trace lines for the motion since the preceding frame, if there is one and the fragment is visible.
pub(super) fn write(subject: &TracedFragment<'_>, recipe: &Recipe, scribe: &mut TraceRecorder) {
    let has_motion = recipe.pipeline.depth_test != DepthTest::Off;
    let is_shown = subject.record.outcome == FragmentOutcome::Visible;
    let Some([camera, camera_before]) = subject.frame.motion_cameras(recipe).filter(|_| has_motion && is_shown) else {
        return;
    };
    let index = subject.triangle.instance as usize;
    let scene_before = subject.frame.before.as_ref().map(|before| &before.scene);
    let Some((scene, instance)) = scene_before.and_then(|scene| Some((scene, scene.instances.get(index)?))) else {
        return;
    };
    let mesh = scene.library.mesh(instance.mesh);
    let now = PlacedTriangle::new(subject, &camera, subject.instance, subject.mesh);
    let before = PlacedTriangle::new(subject, &camera_before, instance, mesh);
    let (Some(now), Some(before)) = (now, before) else { return };
    scribe.enter(TraceStage::Motion);
    if now.px_from_model == before.px_from_model && std::ptr::eq(subject.mesh, mesh) {
        scribe.decide("motion", "neither the object nor the camera has moved", "none");
        return;
    }
    for (name, placed) in [("this frame", &now), ("preceding frame", &before)] {
        corners(subject.raster, name, placed, scribe);
    }
    let forms = PlaneMotion::new(&MovedTriangle { now: now.px, before: before.px, distances: [0.0; 3] });
    vector(&forms, subject.pixel, scribe);
}

/// Writes the corners of the triangle in clip space and in pixels.
fn corners(raster: Viewport, frame: &str, placed: &PlacedTriangle, scribe: &mut TraceRecorder) {
    let (width, height) = (f64::from(raster.width), f64::from(raster.height));
    for (number, clip) in placed.clip.iter().enumerate() {
        let name = |part: &str| format!("corner {number} · {part}, {frame}");
        for (part, value) in [("clip x", clip.x), ("clip y", clip.y), ("clip w", clip.w)] {
            scribe.read(name(part), "the model and view transform of the frame, in f64", value);
        }
        let half = || fraction("½", 1, 2);
        let ndc = |part: &'static str, value: f64| given(part, value) / given("clip w", clip.w);
        let x = (ndc("clip x", clip.x) * half() + half()) * given("width", width);
        let y = (half() - ndc("clip y", clip.y) * half()) * given("height", height);
        scribe.aside(name("x in px"), (clip.x / clip.w * 0.5 + 0.5) * width, &x);
        scribe.aside(name("y in px"), (0.5 - clip.y / clip.w * 0.5) * height, &y);
    }
}

/// Coefficients of the motion of the pixels of a block, as polynomials of the number of the pixel within the block.
struct BlockTerms {
    across: [f32; 3],
    down: [f32; 2],
    /// Change of w from one pixel to the next, relative to the first.
    w_step: f32,
}

/// Writes the linear forms and their values at the first pixel of a block, and returns the coefficients of the block.
fn block_terms(forms: &PlaneMotion, (first, y): (u32, u32), scribe: &mut TraceRecorder) -> BlockTerms {
    let PlaneMotion { column, row, w, .. } = *forms;
    let source = "from the corners of both frames in homogeneous pixels (Olano and Greer, 1997)";
    let at = DVec3::new(f64::from(first) + 0.5, f64::from(y) + 0.5, 1.0);
    scribe.read("x", format!("centre of pixel {first}, the first of {BLOCK} with one exact position"), at.x);
    scribe.read("y", "centre of the row", at.y);
    let mut value_at = |name: &str, form: DVec3| {
        let parts = [("x", form.x), ("y", form.y), ("1", form.z)];
        parts.iter().for_each(|(part, factor)| scribe.read(format!("{name} per {part}"), source, *factor));
        let [x, y, constant] = parts.map(|(part, factor)| given(format!("{name} per {part}"), factor));
        let formula = x * given("x", at.x) + y * given("y", at.y) + constant;
        scribe.compute(name, form.dot(at), &formula);
        form.dot(at)
    };
    let column_at = value_at("column · w", column);
    let row_at = value_at("row · w", row);
    let w_at = value_at("w", w);
    let (per_w, now_w) = (1.0 / w_at, || given("w", w_at));
    let [x, y, w_per_x] =
        [("x", at.x), ("y", at.y), ("w per x", w.x)].map(|(name, number)| move || given(name, number));
    let mut coefficient = |name: &str, value: f64, formula: Formula| {
        let value = (value * per_w) as f32;
        scribe.compute(name, value, &(formula / now_w()));
        value
    };
    let change = given("column · w per x", column.x) - now_w() - x() * w_per_x();
    let across = [
        coefficient("across 0", column_at - at.x * w_at, given("column · w", column_at) - x() * now_w()),
        coefficient("across 1", column.x - w_at - at.x * w.x, change),
        coefficient("across 2", -w.x, -w_per_x()),
    ];
    let down = [
        coefficient("down 0", row_at - at.y * w_at, given("row · w", row_at) - y() * now_w()),
        coefficient("down 1", row.x - at.y * w.x, given("row · w per x", row.x) - y() * w_per_x()),
    ];
    BlockTerms { across, down, w_step: coefficient("w step", w.x, w_per_x()) }
}

/// Writes the vector of a pixel and its position in the preceding frame.
fn vector(forms: &PlaneMotion, (x, y): (u32, u32), scribe: &mut TraceRecorder) {
    let BlockTerms { across: [a, b, c], down: [d, e], w_step } = block_terms(forms, (x - x % BLOCK as u32, y), scribe);
    let place = (x % BLOCK as u32) as f32;
    let k = || given("k", place);
    scribe.read("k", "pixels to the right of the first one", place);
    let divisor = 1.0 + place * w_step;
    scribe.compute("relative w", divisor, &(whole("1", 1) + k() * given("w step", w_step)));
    let motion = [((c * place + b) * place + a) / divisor, (e * place + d) / divisor];
    let across = (given("across 2", c) * k() + given("across 1", b)) * k() + given("across 0", a);
    let down = given("down 1", e) * k() + given("down 0", d);
    for (name, (motion, formula)) in MOTION.into_iter().zip(motion.into_iter().zip([across, down])) {
        scribe.compute(name, motion, &(formula / given("relative w", divisor)));
    }
    for (name, (own, motion)) in
        ["previous x in px", "previous y in px"].into_iter().zip([x, y].into_iter().zip(motion))
    {
        let center = own as f32 + 0.5;
        scribe.compute(name, center + motion, &(given("centre", center) + given("motion", motion)));
    }
}

/// Names of the lines that equal the motion buffers.
const MOTION: [&str; 2] = ["motion x in px", "motion y in px"];

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::chain::{PrecedingView, run};
    use crate::inspect::inspect;
    use crate::inspect::trace::{Number, Trace};
    use crate::scene::builtin;

    #[test]
    fn the_lines_end_in_the_bits_of_the_motion_buffers() {
        let viewport = Viewport { width: 40, height: 24 };
        let scene = Arc::new(builtin::by_id("chess-motion").unwrap().build());
        let (first, second) = (scene.at(0.5), scene.at(0.6));
        let mut turned = scene.home;
        turned.orbit(0.03, 0.01);
        for camera in [scene.home, turned] {
            let recipe = Recipe::default();
            let mut frame = run(&second, &camera, &recipe, viewport, &mut ());
            frame.before = Some(PrecedingView { scene: Arc::clone(&first), camera: scene.home });
            let motion = frame.motion(&second, &recipe).unwrap();
            let (mut moved, mut still) = (0, 0);
            for (x, y) in (0..24).flat_map(|y| (0..40).map(move |x| (x, y))) {
                let report = inspect(&second, &recipe, &frame, x, y).unwrap();
                if report.visible().is_none() {
                    continue;
                }
                let trace = Trace::of(&second, &recipe, &frame, &report, None);
                let number = |name: &str| {
                    trace.lines.iter().find(|line| line.what == name).and_then(super::super::line::TraceLine::number)
                };
                let vector = motion.vector_px(x, y);
                if number(MOTION[0]).is_none() {
                    assert_eq!(vector, [0.0; 2], "({x}, {y})");
                    still += 1;
                    continue;
                }
                for (name, expected) in MOTION.into_iter().zip(vector) {
                    assert_eq!(number(name), Some(Number::F32(expected)), "({x}, {y}) {name}");
                }
                moved += 1;
            }
            assert!(moved > 20 && (camera == turned || still > 100), "{moved} {still}");
        }
    }
}
