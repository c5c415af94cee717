//! Drawing of a probed view, with the triangle that owns each pixel, for comparison between probe runs.

use super::{Probe, ProbedView, jitter};
use crate::image::{Image, Rgba8};
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::Observer;
use crate::pipeline::screen_triangle::ScreenTriangle;
use crate::pipeline::viewport::Viewport;
use crate::pipeline::{DrawCall, Extent, prepare};
use crate::scene::{Camera, Scene, TriangleId};

/// Images of one run that the stability probe compares.
pub(super) struct ProbeImages {
    /// Triangle shaded last at each pixel, or [`TriangleId::NONE`]. With blending, this is normally the nearest
    /// triangle.
    pub(super) owner: Image<TriangleId>,
    /// Stored depth of each pixel; `None` without a depth test.
    pub(super) depth: Option<Image<f32>>,
    /// Colour of each pixel, as sRGB codes.
    pub(super) color: Image<Rgba8>,
}

struct OwnerRecorder(Image<TriangleId>);

impl Observer for OwnerRecorder {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        self.0.set(fragment.sample.column, fragment.sample.row, triangle.id);
    }
}

/// Draws the probed view without jitter.
pub(super) fn draw_still(subject: &ProbedView) -> ProbeImages {
    picture(subject, &subject.scene, &subject.camera)
}

/// Draws the probed view with the jitter of one run.
pub(super) fn jittered(subject: &ProbedView, probe: Probe, run: u16) -> ProbeImages {
    match probe.what {
        super::JitterTarget::Camera => picture(subject, &subject.scene, &jitter::camera(&subject.camera, probe, run)),
        super::JitterTarget::Vertices => picture(subject, &jitter::scene(&subject.scene, probe, run), &subject.camera),
    }
}

fn picture(subject: &ProbedView, scene: &Scene, camera: &Camera) -> ProbeImages {
    let (settings, viewport) = (&subject.settings, subject.viewport);
    let Viewport { width, height } = viewport;
    let geometry = prepare(scene, camera, settings, viewport, &mut ());
    let mut frame = Framebuffer::new(SampleGrid::FULL, width, height, scene.background, settings);
    let mut owners = OwnerRecorder(Image::filled(width, height, TriangleId::NONE));
    let all = Extent::all(&geometry, viewport);
    DrawCall::new(scene, &geometry, settings, &all).draw(&mut frame, &mut owners);
    ProbeImages { owner: owners.0, depth: frame.depth, color: frame.color }
}
