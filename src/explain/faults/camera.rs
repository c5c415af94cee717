//! Faults in the view: aspect ratio, field of view, handedness, position of samples, clipping at the near plane.

use glam::Vec3;
use rasterscope_engine::pipeline::settings::DisabledOptimisation;
use rasterscope_engine::pipeline::viewport::Viewport;
use rasterscope_engine::scene::{Camera, Projection};

use crate::fault::{Change, Fault, Slot};
use crate::geometry;
use crate::polygons;
use crate::setup::Setup;

pub(super) const FAULTS: &[Fault] = &[
    Fault::error(
        "aspect-ignored",
        "the aspect ratio of the picture is ignored",
        Slot::Aspect,
        Change::Setup(|setup| setup.sub_view_mut().aspect = 1.0),
    ),
    Fault::error(
        "aspect-inverted",
        "the aspect ratio is inverted: height over width",
        Slot::Aspect,
        Change::Setup(|setup| setup.sub_view_mut().aspect = 1.0 / setup.viewport.aspect()),
    ),
    Fault::error(
        "fov-horizontal",
        "the vertical field of view is used as the horizontal one",
        Slot::FieldOfView,
        Change::Setup(|setup| {
            let aspect = f64::from(setup.viewport.aspect());
            set_angle(setup, |fov| (2.0 * ((f64::from(fov) * 0.5).tan() / aspect).atan()) as f32);
        }),
    ),
    Fault::error(
        "fov-half",
        "the field of view is used as half the angle, so the view is too wide",
        Slot::FieldOfView,
        Change::Setup(|setup| set_angle(setup, |fov| fov * 2.0)),
    ),
    Fault::error(
        "fov-halved",
        "half the field of view is used, so the view is too narrow",
        Slot::FieldOfView,
        Change::Setup(|setup| set_angle(setup, |fov| fov * 0.5)),
    ),
    Fault::error(
        "left-handed-view",
        "the view is left-handed: left and right are swapped, and front faces count as back faces",
        Slot::Handedness,
        Change::Setup(|setup| {
            let view = setup.sub_view_mut();
            view.scale[0] *= -1.0;
            view.shift[0] *= -1.0;
            // Clusters of triangles are culled by their facing in space, which the mirrored view does not show.
            setup.recipe.pipeline.force = DisabledOptimisation::Clusters;
        }),
    ),
    Fault::error(
        "z-mirrored",
        "the scene is mirrored in z (other handedness), light and camera are not",
        Slot::Handedness,
        Change::Setup(|setup| geometry::mirror(setup, Vec3::new(1.0, 1.0, -1.0))),
    ),
    Fault::error(
        "x-mirrored",
        "the scene is mirrored in x (other handedness), light and camera are not",
        Slot::Handedness,
        Change::Setup(|setup| geometry::mirror(setup, Vec3::new(-1.0, 1.0, 1.0))),
    ),
    Fault::error(
        "corner-samples",
        "pixels are sampled at their top left corners instead of their centres",
        Slot::SamplePosition,
        Change::Setup(|setup| shift_px(setup, [0.5, 0.5])),
    ),
    Fault::error(
        "corner-samples-bottom-left",
        "pixels are sampled at their bottom left corners instead of their centres",
        Slot::SamplePosition,
        Change::Setup(|setup| shift_px(setup, [0.5, -0.5])),
    ),
    Fault::error(
        "corner-samples-top-right",
        "pixels are sampled at their top right corners instead of their centres",
        Slot::SamplePosition,
        Change::Setup(|setup| shift_px(setup, [-0.5, 0.5])),
    ),
    Fault::error(
        "corner-samples-bottom-right",
        "pixels are sampled at their bottom right corners instead of their centres",
        Slot::SamplePosition,
        Change::Setup(|setup| shift_px(setup, [-0.5, -0.5])),
    ),
    Fault::error(
        "near-plane-dropped",
        "triangles that cross the near plane are dropped instead of clipped",
        Slot::NearPlane,
        Change::Setup(geometry::drop_near_crossing),
    ),
    Fault::error(
        "near-plane-unclipped",
        "triangles are not clipped at the near plane: corners behind the eye are projected as if they were before it",
        Slot::NearPlane,
        Change::Setup(polygons::skip_near_clipping_and_test),
    )
    .or(&[Change::Setup(polygons::skip_near_clipping), Change::Setup(geometry::project_through_eye)]),
    Fault::error(
        "near-plane-ignored",
        "surfaces between the eye and the near plane are drawn",
        // It needs a depth format of its own.
        Slot::DepthFormat,
        Change::Setup(geometry::ignore_near_plane),
    ),
];

/// Changes the vertical field of view of a perspective view; an angle that no view can have leaves it unchanged.
fn set_angle(setup: &mut Setup, change: impl Fn(f32) -> f32) {
    let Projection::Perspective { fov_y } = setup.camera.projection else { return };
    let changed = Camera { projection: Projection::Perspective { fov_y: change(fov_y) }, ..setup.camera };
    if changed.check().is_ok() {
        setup.camera = changed;
    }
}

/// Moves the picture right and down by fractions of a pixel.
fn shift_px(setup: &mut Setup, [right, down]: [f32; 2]) {
    let Viewport { width, height } = setup.viewport;
    let [x, y] = &mut setup.sub_view_mut().shift;
    *x += 2.0 * right / width as f32;
    *y -= 2.0 * down / height as f32;
}
