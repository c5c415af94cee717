//! Inputs of upscalers besides the drawn colours: the visible object and its distance in every pixel, and the previous
//! frame.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use crate::image::{Image, Rgba8};
use crate::scene::{Camera, Projection};

mod wide;

pub(super) use wide::{NOT_VISIBLE, same_surface};

/// Visible surface of every pixel in the full image, determined without shading. Alpha-tested and transparent surfaces
/// count as opaque.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct GBuffer {
    /// Object in each pixel, encoded as an id colour; the background colour where there is none.
    pub(crate) object: Image<Rgba8>,
    /// Distance along the view axis, in world units. Where there is no surface, it is infinite or the distance of the
    /// far plane.
    pub(crate) distance: Image<f32>,
}

/// Relative difference up to which two distances count as equal: depths are rounded, and pixels sample slightly
/// different positions.
const SAME_DISTANCE: f32 = 0.02;

impl GBuffer {
    /// Whether a pixel shows this object at about this distance.
    pub(crate) fn shows(&self, (x, y): (u32, u32), object: Rgba8, distance: f32) -> bool {
        let there = self.distance.at(x, y);
        let near = (there - distance).abs() <= SAME_DISTANCE * distance.abs();
        self.object.at(x, y) == object && (near || there == distance)
    }

    /// Whether two pixels show the same object at about the same distance.
    pub(crate) fn same_surface(&self, a: (u32, u32), b: (u32, u32)) -> bool {
        self.shows(a, self.object.at(b.0, b.1), self.distance.at(b.0, b.1))
    }
}

/// Previous frame, as read by upscalers with history.
#[derive(Clone, Debug)]
pub struct History {
    /// Full image of the frame; `None` if the upscaler stores its own history.
    pub(crate) picture: Option<Image<Rgba8>>,
    /// The upscaler's own history, with higher precision than the image.
    pub(crate) accumulated: Option<Image<[f32; 4]>>,
    /// Visible surfaces of the previous frame.
    pub(crate) surfaces: Arc<GBuffer>,
    /// Camera of the previous frame.
    pub(crate) camera: Camera,
    /// Number of frames before the previous frame that belong to the same history.
    pub(crate) frames: u32,
    /// Number of consecutive frames with an unchanged camera, up to and including the previous frame.
    pub(crate) still_frames: u32,
}

/// Inputs of the current frame besides its colours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameInputs<'a> {
    /// Visible surfaces of the current frame.
    pub(crate) gbuffer: &'a GBuffer,
    /// Camera of the current frame.
    pub(crate) camera: &'a Camera,
    /// Previous frame, if it shows the same scene with the same recipe.
    pub(crate) history: Option<&'a History>,
}

impl FrameInputs<'_> {
    /// Returns the number of earlier frames in the history of the current one.
    pub(crate) fn frames(&self) -> u32 {
        self.history.map_or(0, |past| past.frames + 1)
    }

    /// Reprojects pixel `at` into the previous frame. Returns `None` if that frame does not show the pixel's surface,
    /// or if there is no previous frame. For many pixels, call [`Self::motion`] once.
    pub(crate) fn reproject(&self, size: (u32, u32), at: (u32, u32)) -> Option<Reprojected> {
        self.motion(size)?.reproject(at)
    }
}

impl<'a> FrameInputs<'a> {
    /// Returns the motion since the previous frame, or `None` if there is no previous frame.
    pub(crate) fn motion(&self, size: (u32, u32)) -> Option<Motion<'a>> {
        let past = self.history?;
        let path = (past.camera != *self.camera).then(|| ViewChange::new([self.camera, &past.camera], size));
        Some(Motion { history: past, gbuffer: self.gbuffer, size, path })
    }
}

/// Camera motion since the previous frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<'a> {
    /// Previous frame, into which pixels are reprojected.
    pub(crate) history: &'a History,
    gbuffer: &'a GBuffer,
    size: (u32, u32),
    /// Change of view; `None` if the camera is unchanged.
    path: Option<ViewChange>,
}

impl Motion<'_> {
    /// Reprojects pixel `at` into the previous frame. Returns `None` if that frame does not show the pixel's surface.
    pub(crate) fn reproject(&self, at: (u32, u32)) -> Option<Reprojected> {
        let center = [f64::from(at.0) + 0.5, f64::from(at.1) + 0.5];
        let Some(path) = &self.path else {
            return Some(Reprojected { place: center, is_still: true });
        };
        let distance = self.gbuffer.distance.at(at.0, at.1);
        let (place, expected) = path.moved(center, distance.into())?;
        let inside = |at: f64, length: u32| at >= 0.0 && at < f64::from(length);
        if !inside(place[0], self.size.0) || !inside(place[1], self.size.1) {
            return None;
        }
        let pixel = (place[0] as u32, place[1] as u32);
        let same = self.history.surfaces.shows(pixel, self.gbuffer.object.at(at.0, at.1), expected as f32);
        same.then_some(Reprojected { place, is_still: false })
    }
}

/// Position of a pixel in the previous frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reprojected {
    /// Position in pixels from the top left corner of the image.
    pub(crate) place: [f64; 2],
    /// Whether the camera is unchanged, so that the position is the centre of the same pixel.
    pub(crate) is_still: bool,
}

impl Reprojected {
    /// Samples an image bilinearly at this position; reads the pixel itself if the camera is unchanged.
    pub(crate) fn read<const N: usize>(&self, size: (u32, u32), value: impl Fn(u32, u32) -> [f32; N]) -> [f32; N] {
        let [x, y] = self.place;
        if self.is_still {
            return value(x as u32, y as u32);
        }
        let axis = |at: f64, length: u32| {
            let (floor, last) = ((at - 0.5).floor(), f64::from(length - 1));
            let pixel = |at: f64| at.clamp(0.0, last) as u32;
            ([pixel(floor), pixel(floor + 1.0)], (at - 0.5 - floor) as f32)
        };
        let ((columns, right), (rows, down)) = (axis(x, size.0), axis(y, size.1));
        let row = |row: u32| {
            let [a, b] = columns.map(|column| value(column, row));
            std::array::from_fn::<f32, N, _>(|channel| a[channel] + (b[channel] - a[channel]) * right)
        };
        let [a, b] = rows.map(row);
        std::array::from_fn(|channel| a[channel] + (b[channel] - a[channel]) * down)
    }
}

/// Mapping between the pixels and the view space of a camera.
#[derive(Clone, Copy, Debug)]
struct Lens {
    /// Half the width and height of the visible region, in world units: at distance 1 for perspective projection, at
    /// any distance for orthographic projection.
    half: [f64; 2],
    size: [f64; 2],
    in_perspective: bool,
}

impl Lens {
    fn new(camera: &Camera, (width, height): (u32, u32)) -> Self {
        let (half_height, in_perspective) = match camera.projection {
            Projection::Perspective { fov_y } => ((f64::from(fov_y) * 0.5).tan(), true),
            Projection::Orthographic { height } => (f64::from(height) * 0.5, false),
        };
        let size = [f64::from(width), f64::from(height)];
        Self { half: [half_height * size[0] / size[1], half_height], size, in_perspective }
    }

    /// Returns the horizontal view-space offset that corresponds to a column position in pixels: at distance 1 for
    /// perspective projection, at any distance for orthographic projection.
    fn right_of(&self, x: f64) -> f64 {
        (x / self.size[0] * 2.0 - 1.0) * self.half[0]
    }

    /// Returns the vertical view-space offset that corresponds to a row position in pixels; see [`Self::right_of`].
    fn up_of(&self, y: f64) -> f64 {
        (1.0 - y / self.size[1] * 2.0) * self.half[1]
    }

    /// Returns the view-space point that is visible at a position in pixels, at the given distance.
    fn point(&self, [x, y]: [f64; 2], distance: f64) -> DVec3 {
        let spread = if self.in_perspective { distance } else { 1.0 };
        DVec3::new(self.right_of(x) * spread, self.up_of(y) * spread, -distance)
    }

    /// Projects a view-space point to a position in pixels and a distance. Returns `None` for points behind the eye.
    fn place(&self, point: DVec3) -> Option<([f64; 2], f64)> {
        let distance = -point.z;
        let spread = if self.in_perspective { distance } else { 1.0 };
        let ndc = [point.x / (self.half[0] * spread), point.y / (self.half[1] * spread)];
        let place = [(ndc[0] + 1.0) / 2.0 * self.size[0], (1.0 - ndc[1]) / 2.0 * self.size[1]];
        (distance > 0.0 && place.iter().all(|at| at.is_finite())).then_some((place, distance))
    }
}

/// Transformation from the view of one camera to that of another.
#[derive(Clone, Copy, Debug)]
struct ViewChange {
    lenses: [Lens; 2],
    to_from: DMat4,
}

impl ViewChange {
    fn new(cameras: [&Camera; 2], size: (u32, u32)) -> Self {
        let [from, to] = cameras.map(Camera::view_from_world_f64);
        Self { lenses: cameras.map(|camera| Lens::new(camera, size)), to_from: to * from.inverse() }
    }

    /// Transforms a point from the first view to the second. In both, the point is given by its position in pixels and
    /// its distance. Returns `None` if it is behind the eye.
    fn moved(&self, place: [f64; 2], distance: f64) -> Option<([f64; 2], f64)> {
        let [from, to] = &self.lenses;
        to.place(self.to_from.transform_point3(from.point(place, distance)))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use glam::{Vec3, Vec4};

    use super::*;
    use crate::scene::DepthMapping;

    /// Inputs of one test frame, with its history.
    pub(in crate::upscale) struct Frames {
        surfaces: GBuffer,
        camera: Camera,
        past: Option<History>,
    }

    impl Frames {
        pub(in crate::upscale) fn seen(&self) -> FrameInputs<'_> {
            FrameInputs { gbuffer: &self.surfaces, camera: &self.camera, history: self.past.as_ref() }
        }
    }

    /// Returns test frames of a few slanted objects at different distances and an empty background. The first has no
    /// history, and the second an unchanged camera. In the others, the camera moves in perspective or orthographic
    /// projection, or the projection changes.
    pub(in crate::upscale) fn frames((width, height): (u32, u32), number: u32) -> Vec<Frames> {
        let mut random = fastrand::Rng::with_seed(u64::from(number));
        let surfaces = GBuffer {
            object: Image::from_fn(width, height, |x, y| [(x / 23) as u8, (y / 4) as u8, 0, 255]),
            distance: Image::from_fn(width, height, |x, y| {
                if x / 23 == 1 { f32::INFINITY } else { 4.0 + (x / 23) as f32 * 0.3 + y as f32 * 0.01 }
            }),
        };
        let picture = Image::from_fn(width, height, |_, _| std::array::from_fn(|_| random.u8(..)));
        let memory =
            Image::from_fn(width, height, |_, _| [random.f32(), random.f32(), random.f32(), 1.0 + 20.0 * random.f32()]);
        let near = Camera::look_at(Vec3::new(1.0, 2.0, 5.0), Vec3::ZERO);
        let moved = Camera { eye: near.eye + Vec3::new(0.03, -0.02, 0.02), ..near };
        let flat = |camera: Camera| camera.with_orthographic(true);
        let views =
            [None, Some((near, near)), Some((near, moved)), Some((flat(near), flat(moved))), Some((near, flat(near)))];
        let of = |views: Option<(Camera, Camera)>| Frames {
            surfaces: surfaces.clone(),
            camera: views.map_or(near, |(camera, _)| camera),
            past: views.map(|(_, camera)| History {
                picture: Some(picture.clone()),
                accumulated: Some(memory.clone()),
                surfaces: Arc::new(surfaces.clone()),
                camera,
                frames: number,
                still_frames: 1,
            }),
        };
        views.map(of).into()
    }

    #[test]
    fn a_point_is_found_where_the_other_camera_projects_it() {
        let mut random = fastrand::Rng::with_seed(4);
        let size = (320, 180);
        for orthographic in [false, true] {
            let mut cameras = [Vec3::new(1.0, 2.0, 5.0), Vec3::new(1.4, 1.8, 4.6)]
                .map(|eye| Camera::look_at(eye, Vec3::ZERO).with_orthographic(orthographic));
            cameras[1].up = Vec3::new(0.1, 1.0, 0.0);
            let project = |camera: &Camera, point: Vec3| {
                let clip: Vec4 = camera.clip_from_world(320.0 / 180.0, DepthMapping::Standard) * point.extend(1.0);
                let ndc = clip / clip.w;
                let view = camera.view_from_world().transform_point3(point);
                ([(f64::from(ndc.x) + 1.0) * 160.0, (1.0 - f64::from(ndc.y)) * 90.0], f64::from(-view.z))
            };
            for _ in 0..200 {
                let point = Vec3::new(random.f32(), random.f32(), random.f32()) - 0.5;
                let (place, distance) = project(&cameras[0], point);
                let (found, how_far) = ViewChange::new(cameras.each_ref(), size).moved(place, distance).unwrap();
                let (expected, expected_distance) = project(&cameras[1], point);
                assert!((how_far - expected_distance).abs() < 1e-4);
                assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.01), "{found:?} {expected:?}");
            }
        }
    }
}
