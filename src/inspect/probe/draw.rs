//! One picture with the owner of every pixel.

use super::{Probe, Subject, jitter};
use crate::image::{Image, Rgba8};
use crate::pipeline::framebuffer::Framebuffer;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::interpolate::Fragment;
use crate::pipeline::observe::Observer;
use crate::pipeline::viewport::{ScreenTriangle, Viewport};
use crate::pipeline::{Extent, Until, draw, prepare};
use crate::scene::{Camera, Scene, TriangleId};

/// A picture in the respects that are compared.
pub(super) struct Drawn {
    /// Who won each pixel, the nearest where some are blended, or [`TriangleId::NONE`].
    pub(super) owner: Image<TriangleId>,
    /// Stored depth; `None` without a depth test.
    pub(super) depth: Option<Image<f32>>,
    /// Colours.
    pub(super) color: Image<Rgba8>,
}

struct Owners(Image<TriangleId>);

impl Observer for Owners {
    fn shaded(&mut self, triangle: &ScreenTriangle, fragment: &Fragment, _color: Rgba8) {
        self.0.set(fragment.sample.column, fragment.sample.row, triangle.id);
    }
}

/// The subject as it is.
pub(super) fn still(subject: &Subject) -> Drawn {
    picture(subject, &subject.scene, &subject.camera)
}

/// The subject as a run of the probe moves it.
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
