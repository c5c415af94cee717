//! Faults of the depth buffer: test, order of drawing, precision.

use crate::fault::{Change, Fault, Slot};
use crate::geometry;

pub(super) const FAULTS: &[Fault] = &[
    Fault::error(
        "depth-test-off",
        "there is no depth test: the last triangle drawn wins",
        Slot::DepthTest,
        Change::Settings(&["depth-test=off"]),
    ),
    Fault::error(
        "depth-test-reversed",
        "the depth test is reversed: the farthest surface wins",
        Slot::DepthTest,
        Change::Settings(&["depth-test=greater"]),
    ),
    Fault::error(
        "painters-algorithm",
        "triangles are sorted by depth and drawn without a depth test (painter's algorithm)",
        Slot::DepthTest,
        Change::Setup(|setup| {
            let (eye, forward) = (setup.camera.eye, setup.camera.forward());
            geometry::sort_triangles(setup, |[a, b, c]| (a + b + c - 3.0 * eye).dot(forward));
        }),
    ),
    Fault::error(
        "painters-algorithm-by-eye",
        "triangles are sorted by the distance of their centroids from the eye and drawn without a depth test",
        Slot::DepthTest,
        Change::Setup(|setup| {
            let eye = setup.camera.eye;
            geometry::sort_triangles(setup, |[a, b, c]| ((a + b + c) / 3.0).distance(eye));
        }),
    ),
    Fault::error(
        "depth-not-cleared",
        "nothing is drawn, for example because the depth buffer is not cleared and no fragment passes the depth test",
        Slot::DepthTest,
        Change::Setup(geometry::remove_objects),
    ),
    Fault::convention(
        "depth-test-less-equal",
        "at equal depth, the last triangle drawn wins",
        Slot::DepthTest,
        Change::Settings(&["depth-test=less-equal"]),
    ),
    Fault::error(
        "depth-16-bit",
        "depths are stored in 16 bits: close surfaces z-fight",
        Slot::DepthFormat,
        Change::Settings(&["depth-format=unorm16"]),
    ),
    Fault::convention(
        "depth-24-bit",
        "depths are stored in 24 bits",
        Slot::DepthFormat,
        Change::Settings(&["depth-format=unorm24"]),
    ),
];
