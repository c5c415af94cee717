//! What methods read besides the colours that were drawn: which surface every pixel of the full picture shows, how far away it
//! is, and what the last frame was.

use std::sync::Arc;

use glam::{DMat4, DVec3};

use crate::image::{Image, Rgba8};
use crate::scene::{Camera, Projection};

mod wide;

pub(super) use wide::{NOWHERE, same_surface};

/// What every pixel of the full picture shows, found without shading it. What is cut out or blended counts as if it were
/// opaque.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfaces {
    /// A colour for each object, and the background where there is none.
    pub object: Image<Rgba8>,
    /// Distance along the line of sight, world units; beyond all surfaces infinite, or the far plane.
    pub distance: Image<f32>,
}

/// A share of the distance by which the same surface may seem nearer or farther: depths are rounded, and pixels look at
/// slightly different places.
const SAME_DISTANCE: f32 = 0.02;

impl Surfaces {
    /// Whether a place shows the object, and about the distance, that is asked for.
    pub fn shows(&self, (x, y): (u32, u32), object: Rgba8, distance: f32) -> bool {
        let there = self.distance.at(x, y);
        let near = (there - distance).abs() <= SAME_DISTANCE * distance.abs();
        self.object.at(x, y) == object && (near || there == distance)
    }

    /// Whether two places show the same object at about the same distance.
    pub fn are_one(&self, a: (u32, u32), b: (u32, u32)) -> bool {
        self.shows(a, self.object.at(b.0, b.1), self.distance.at(b.0, b.1))
    }
}

/// A frame that was drawn before.
#[derive(Clone, Debug)]
pub struct History {
    /// Its full picture, unless the method remembers more.
    pub picture: Option<Image<Rgba8>>,
    /// What the method remembers more precisely than the picture can.
    pub memory: Option<Image<[f32; 4]>>,
    /// What it showed.
    pub surfaces: Arc<Surfaces>,
    /// Its view.
    pub camera: Camera,
    /// How many frames came before it without a break.
    pub frames: u32,
    /// How many of the last ones, with it, had the same view.
    pub still: u32,
}

/// What is known of the frame that is filled in.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// What it shows.
    pub surfaces: &'a Surfaces,
    /// Its view.
    pub camera: &'a Camera,
    /// The frame before it, if it shows the same scene by the same recipe.
    pub past: Option<&'a History>,
}

impl Seen<'_> {
    /// How many frames came before without a break.
    pub fn frames(&self) -> u32 {
        self.past.map_or(0, |past| past.frames + 1)
    }

    /// Where the frame before showed what pixel `at` shows, px from the corner of the picture, if it showed it at all. For
    /// many pixels ask [`Self::motion`] once.
    pub fn before(&self, size: (u32, u32), at: (u32, u32)) -> Option<Before> {
        self.motion(size)?.before(at)
    }
}

impl<'a> Seen<'a> {
    /// How places of a picture have moved since the frame before, if there is one.
    pub fn motion(&self, size: (u32, u32)) -> Option<Motion<'a>> {
        let past = self.past?;
        let path = (past.camera != *self.camera).then(|| Path::new([self.camera, &past.camera], size));
        Some(Motion { past, surfaces: self.surfaces, size, path })
    }
}

/// How places of a picture have moved since the frame before.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// The frame before.
    pub past: &'a History,
    surfaces: &'a Surfaces,
    size: (u32, u32),
    /// None while the view stands still.
    path: Option<Path>,
}

impl Motion<'_> {
    /// Where the frame before showed what pixel `at` shows, px from the corner of the picture, if it showed it at all.
    pub fn before(&self, at: (u32, u32)) -> Option<Before> {
        let center = [f64::from(at.0) + 0.5, f64::from(at.1) + 0.5];
        let Some(path) = &self.path else {
            return Some(Before { place: center, is_still: true });
        };
        let distance = self.surfaces.distance.at(at.0, at.1);
        let (place, expected) = path.moved(center, distance.into())?;
        let inside = |at: f64, length: u32| at >= 0.0 && at < f64::from(length);
        if !inside(place[0], self.size.0) || !inside(place[1], self.size.1) {
            return None;
        }
        let pixel = (place[0] as u32, place[1] as u32);
        let same = self.past.surfaces.shows(pixel, self.surfaces.object.at(at.0, at.1), expected as f32);
        same.then_some(Before { place, is_still: false })
    }
}

/// Where a pixel was in the frame before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Before {
    /// Px from the corner of the picture.
    pub place: [f64; 2],
    /// Whether the view was the same, so that it is the very same pixel.
    pub is_still: bool,
}

impl Before {
    /// A picture at this place, between the centres of its four pixels around; the pixel itself if nothing moved.
    pub fn read<const N: usize>(&self, size: (u32, u32), value: impl Fn(u32, u32) -> [f32; N]) -> [f32; N] {
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

/// How a view's pixels lie around its line of sight.
#[derive(Clone, Copy, Debug)]
struct Lens {
    /// Half of the picture's width and height, in world units, at distance 1 in perspective and everywhere without.
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

    /// How far to the right of the line of sight a column is seen, px, at distance 1 in perspective and everywhere without.
    fn right_of(&self, x: f64) -> f64 {
        (x / self.size[0] * 2.0 - 1.0) * self.half[0]
    }

    /// How far above the line of sight a row is seen; see [`Self::right_of`].
    fn up_of(&self, y: f64) -> f64 {
        (1.0 - y / self.size[1] * 2.0) * self.half[1]
    }

    /// The point at a distance that is seen at a place, px; view space.
    fn point(&self, [x, y]: [f64; 2], distance: f64) -> DVec3 {
        let spread = if self.in_perspective { distance } else { 1.0 };
        DVec3::new(self.right_of(x) * spread, self.up_of(y) * spread, -distance)
    }

    /// Where a point of view space is seen, px, and how far away it is; nowhere behind the eye.
    fn place(&self, point: DVec3) -> Option<([f64; 2], f64)> {
        let distance = -point.z;
        let spread = if self.in_perspective { distance } else { 1.0 };
        let ndc = [point.x / (self.half[0] * spread), point.y / (self.half[1] * spread)];
        let place = [(ndc[0] + 1.0) / 2.0 * self.size[0], (1.0 - ndc[1]) / 2.0 * self.size[1]];
        (distance > 0.0 && place.iter().all(|at| at.is_finite())).then_some((place, distance))
    }
}

/// The way from one view to another.
#[derive(Clone, Copy, Debug)]
struct Path {
    lenses: [Lens; 2],
    to_from: DMat4,
}

impl Path {
    fn new(cameras: [&Camera; 2], size: (u32, u32)) -> Self {
        let [from, to] = cameras.map(Camera::view_from_world_f64);
        Self { lenses: cameras.map(|camera| Lens::new(camera, size)), to_from: to * from.inverse() }
    }

    /// Where the second view sees what the first one sees at a place and a distance.
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

    /// What neighbouring frames may know of each other.
    pub(in crate::upscale) struct Frames {
        surfaces: Surfaces,
        camera: Camera,
        past: Option<History>,
    }

    impl Frames {
        pub(in crate::upscale) fn seen(&self) -> Seen<'_> {
            Seen { surfaces: &self.surfaces, camera: &self.camera, past: self.past.as_ref() }
        }
    }

    /// A few objects, one behind the other and slanted, before nothing, and frames of them: without a past, with the same view, and
    /// with another one in perspective and without.
    pub(in crate::upscale) fn frames((width, height): (u32, u32), number: u32) -> Vec<Frames> {
        let mut random = fastrand::Rng::with_seed(u64::from(number));
        let surfaces = Surfaces {
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
                memory: Some(memory.clone()),
                surfaces: Arc::new(surfaces.clone()),
                camera,
                frames: number,
                still: 1,
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
                let (found, how_far) = Path::new(cameras.each_ref(), size).moved(place, distance).unwrap();
                let (expected, expected_distance) = project(&cameras[1], point);
                assert!((how_far - expected_distance).abs() < 1e-4);
                assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.01), "{found:?} {expected:?}");
            }
        }
    }
}
