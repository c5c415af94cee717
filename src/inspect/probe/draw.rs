//! A picture with the owner of every pixel, for comparison between runs.

use super::{Probe, Subject, jitter};
use crate::image::{Image, Rgba8};
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::Observer;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{Extent, Until, draw, prepare};
use crate::scene::{Camera, Scene, TriangleId};

/// The compared aspects of a picture.
pub(super) struct Drawn {
    /// Triangle shaded last at each pixel, or [`TriangleId::NONE`]. Where triangles are blended, this is normally the
    /// nearest.
    pub(super) owner: Image<TriangleId>,
    /// Stored depth; `None` without a depth test.
    pub(super) depth: Option<Image<f32>>,
    /// Colours, as sRGB codes.
    pub color: Image<Rgba8>,
}

struct Owners(Image<TriangleId>);

impl Observer for Owners {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        self.0.set(fragment.sample.column, fragment.sample.row, triangle.id);
    }
}

/// Draws the subject without jitter.
pub(super) fn still(subject: &Subject) -> Drawn {
    picture(subject, &subject.scene, &subject.camera)
}

/// Draws the subject with the jitter of one run of the probe.
pub(super) fn jittered(subject: &Subject, probe: Probe, run: u16) -> Drawn {
    match probe.what {
        super::Jittered::Camera => picture(subject, &subject.scene, &jitter::camera(&subject.camera, probe, run)),
        super::Jittered::Vertices => picture(subject, &jitter::scene(&subject.scene, probe, run), &subject.camera),
    }
}

fn picture(subject: &Subject, scene: &Scene, camera: &Camera) -> Drawn {
    let (settings, viewport) = (&subject.settings, subject.viewport);
    let Viewport { width, height } = viewport;
    let geometry = prepare(scene, camera, settings, viewport, &mut ());
    let mut frame = Framebuffer::new(SampleGrid::FULL, width, height, scene.background, settings);
    let mut owners = Owners(Image::filled(width, height, TriangleId::NONE));
    let all = Extent::all(&geometry, viewport);
    draw(scene, &geometry, settings, &all, Until::Shade, &mut frame, &mut owners);
    Drawn { owner: owners.0, depth: frame.depth, color: frame.color }
}
