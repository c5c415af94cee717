//! Motion vectors: the position of every visible surface point in the preceding frame.
//!
//! The motion is exact: it follows from the transforms of camera and objects in both frames, and from the vertices of
//! deformed meshes, not from depths. It depends only on the pixel and the triangle visible there, so it is bit-identical
//! for every execution and any number of threads. The background moves as if it were infinitely far away.
//!
//! A surface point is *disoccluded* if the preceding frame does not show it: it was hidden, outside the picture or
//! behind the eye.

mod block;
mod plane;
#[cfg(test)]
mod tests;
mod visibility;

use glam::{DMat4, DVec3, DVec4};
use rayon::prelude::*;

use self::block::{Block, Cache};
pub(crate) use self::plane::{BLOCK, MovedTriangle, PlaneMotion};
use super::gbuffer::GBuffer;
use super::viewport::Viewport;
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::scene::{Camera, DepthMapping, Mesh, Projection, Scene, TriangleId};

/// Scene and camera of one frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameView<'a> {
    /// Scene at the time of the frame.
    pub scene: &'a Scene,
    /// Camera of the frame, without jitter.
    pub camera: &'a Camera,
}

/// Motion of every pixel of a frame since the preceding frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MotionVectors {
    /// Column in the preceding frame minus column in this frame, in pixels of the full picture; not finite if the point
    /// was in the plane of the eye.
    pub(crate) across_px: Image<f32>,
    /// Row in the preceding frame minus row in this frame, in pixels of the full picture; not finite if the point was in
    /// the plane of the eye.
    pub(crate) down_px: Image<f32>,
    /// [`MotionVectors::VISIBLE`] if the preceding frame shows the surface point, or 0 if it is disoccluded.
    pub(crate) visible: Image<u8>,
}

impl MotionVectors {
    /// Value of [`MotionVectors::visible`] in pixels that the preceding frame shows.
    pub(crate) const VISIBLE: u8 = u8::MAX;

    /// Creates vectors for a picture of `width` × `height` px with arbitrary values, in the buffers of `spare`.
    fn reusing(spare: Option<Self>, (width, height): (u32, u32)) -> Self {
        let (across, down, visible) = match spare {
            Some(spare) => (Some(spare.across_px), Some(spare.down_px), Some(spare.visible)),
            None => (None, None, None),
        };
        Self {
            across_px: Image::reusing(across, width, height, 0.0),
            down_px: Image::reusing(down, width, height, 0.0),
            visible: Image::reusing(visible, width, height, 0),
        }
    }

    /// Returns the vector of a pixel, in pixels to the right and downwards, if the preceding frame shows its surface.
    pub(crate) fn visible_vector(&self, (x, y): (u32, u32)) -> Option<[f32; 2]> {
        let is_visible = self.visible.at(x, y) == Self::VISIBLE;
        is_visible.then(|| [self.across_px.at(x, y), self.down_px.at(x, y)])
    }

    /// Returns the memory use in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.across_px.bytes() + self.down_px.bytes() + self.visible.bytes()
    }
}

/// Motion of one surface point since the preceding frame.
#[cfg(test)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PointMotion {
    /// Position in the preceding frame minus the position in the current one, in pixels to the right and downwards.
    pub(crate) vector_px: [f32; 2],
    /// Distance in the preceding frame along its view axis, in world units. For the background, the distance in the
    /// current frame.
    pub(crate) distance: f32,
    /// Whether the preceding frame shows the point.
    pub(crate) is_visible: bool,
}

/// Preceding frame: its view and what it shows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameBefore<'a> {
    /// Scene and camera of the preceding frame.
    pub(crate) view: FrameView<'a>,
    /// Visible surfaces of the preceding frame.
    pub(crate) gbuffer: &'a GBuffer,
}

/// Motion between two frames, from which that of any pixel can be computed.
pub(crate) struct FrameMotion<'a> {
    size: (u32, u32),
    instances: Vec<InstanceMotion<'a>>,
    first_triangles: Vec<TriangleId>,
    triangles: usize,
    /// Motion of the background; `None` if it is still.
    background: Option<PlaneMotion>,
    before: Option<&'a GBuffer>,
    /// Pixels of the full picture per pixel.
    scale: f32,
}

/// Motion of one instance between two frames.
struct InstanceMotion<'a> {
    now: Placed<'a>,
    /// Placement in the preceding frame; `None` if neither the instance nor the camera moved.
    before: Option<Placed<'a>>,
}

/// Mesh and its transform to the picture of a frame.
struct Placed<'a> {
    mesh: &'a Mesh,
    /// Transform from model space to homogeneous pixels (x·w, y·w, w), and to the distance along the view axis.
    px_from_model: DMat4,
}

/// Motion of one triangle, and the encoded index of its instance.
#[derive(Clone, Copy)]
struct TriangleMotion {
    object: Rgba8,
    /// `None` if the triangle is still.
    plane: Option<PlaneMotion>,
}

/// Returns the transform from world space to homogeneous pixels (x·w, y·w, w), and to the distance along the view axis.
pub(crate) fn px_from_world(camera: &Camera, (width, height): (u32, u32)) -> DMat4 {
    let aspect = Viewport { width, height }.aspect();
    let clip = camera.clip_from_world_f64(aspect, DepthMapping::STANDARD);
    let half = [f64::from(width) * 0.5, f64::from(height) * 0.5];
    let (x, y, w) = (clip.row(0), clip.row(1), clip.row(3));
    let distance = -camera.view_from_world_f64().row(2);
    DMat4::from_cols((x + w) * half[0], (w - y) * half[1], w, distance).transpose()
}

impl<'a> FrameMotion<'a> {
    /// Prepares the motion from `before` to `now` in pictures of `size` px. Without a preceding frame, only objects
    /// are found. Both scenes must be poses of the same scene.
    pub(crate) fn new(now: FrameView<'a>, before: Option<FrameBefore<'a>>, size: (u32, u32)) -> Self {
        let place = |view: FrameView<'a>| {
            let px_from_world = px_from_world(view.camera, size);
            view.scene.instances.iter().map(move |instance| Placed {
                mesh: view.scene.library.mesh(instance.mesh),
                px_from_model: px_from_world * instance.world_from_model.as_dmat4(),
            })
        };
        let moved = |(now, before): (Placed<'a>, Placed<'a>)| {
            let is_still = now.px_from_model == before.px_from_model && std::ptr::eq(now.mesh, before.mesh);
            InstanceMotion { now, before: (!is_still).then_some(before) }
        };
        let instances = match before {
            Some(before) => place(now).zip(place(before.view)).map(moved).collect(),
            None => place(now).map(|now| InstanceMotion { now, before: None }).collect(),
        };
        Self {
            size,
            instances,
            first_triangles: now.scene.first_triangles(),
            triangles: now.scene.triangle_count(),
            background: before.and_then(|before| background([now.camera, before.view.camera], size)),
            before: before.map(|before| before.gbuffer),
            scale: 1.0,
        }
    }

    /// Returns the same motion with vectors in pixels of a picture that has `scale` times the resolution.
    pub(crate) fn scaled(self, scale: f32) -> Self {
        Self { scale, ..self }
    }

    /// Returns the motion of a triangle, given by the bytes of its id; the background for any other value.
    fn of_triangle(&self, id: Rgba8) -> TriangleMotion {
        let id = u32::from_le_bytes(id);
        let background = TriangleMotion { object: GBuffer::NO_OBJECT, plane: self.background };
        if id as usize >= self.triangles {
            return background;
        }
        let index = self.first_triangles.partition_point(|first| first.0 <= id) - 1;
        let (InstanceMotion { now, before }, number) =
            (&self.instances[index], (id - self.first_triangles[index].0) as usize);
        let plane = before.as_ref().and_then(|before| {
            let (now, before) = (now.corners(number)?, before.corners(number)?);
            Some(PlaneMotion::new(&MovedTriangle {
                now: now.map(DVec4::truncate),
                before: before.map(DVec4::truncate),
                distances: before.map(|corner| corner.w),
            }))
        });
        TriangleMotion { object: (index as u32).to_le_bytes(), plane }
    }

    /// Returns the motion of the point that a pixel shows, given the bytes of the triangle's id, and its distance in
    /// the current frame. Bit-identical to [`Self::resolve`].
    #[cfg(test)]
    pub(crate) fn of_pixel(&self, (x, y): (u32, u32), id: Rgba8, distance: f32) -> PointMotion {
        let first = x - x % BLOCK as u32;
        let motion = self.of_triangle(id);
        let place = (x - first) as usize;
        let mut block = Block::still(&[distance; BLOCK]);
        block.set(&motion, place..place + 1, (first, y));
        let objects = [motion.object; BLOCK];
        let visible = on_lanes!(Lanes::best(), simd => {
            self.before.map(|before| before.shows_moved(simd, (first, y), &objects, &block))
        });
        PointMotion {
            vector_px: [block.across_px[place], block.down_px[place]].map(|px| px * self.scale),
            distance: block.distance[place],
            is_visible: visible.is_some_and(|visible| visible[place] == MotionVectors::VISIBLE),
        }
    }

    /// Replaces the triangle ids in `ids` by the objects of a G-buffer, and returns the motion of all pixels, unless
    /// there is no preceding frame. `distances` holds the distance of every pixel in the current frame. The result
    /// reuses the buffers of `spare`.
    pub(crate) fn resolve(
        &self,
        lanes: Lanes,
        ids: &mut Image<Rgba8>,
        distances: &Image<f32>,
        spare: Option<MotionVectors>,
    ) -> Option<MotionVectors> {
        /// Rows that one task processes with a cache of its own.
        const ROWS: usize = 32;
        let width = self.size.0 as usize;
        if self.before.is_none() {
            ids.pixels_mut().par_chunks_mut(width * ROWS).for_each(|ids| {
                let mut cache = Cache::default();
                for run in ids.chunk_by_mut(|a, b| a == b) {
                    run.fill(cache.get(self, run[0]).object);
                }
            });
            return None;
        }
        let mut vectors = MotionVectors::reusing(spare, self.size);
        let bands = ids.pixels_mut().par_chunks_mut(width * ROWS).zip(distances.pixels().par_chunks(width * ROWS));
        let MotionVectors { across_px, down_px, visible } = &mut vectors;
        let across_px = across_px.pixels_mut().par_chunks_mut(width * ROWS);
        let down_px = down_px.pixels_mut().par_chunks_mut(width * ROWS);
        let visible = visible.pixels_mut().par_chunks_mut(width * ROWS);
        bands.zip(across_px.zip(down_px).zip(visible)).enumerate().for_each(|(band, (surface, vectors))| {
            let ((ids, distances), ((across_px, down_px), visible)) = (surface, vectors);
            let mut cache = Cache::default();
            let rows = ids.chunks_mut(width).zip(distances.chunks(width));
            let vectors = across_px.chunks_mut(width).zip(down_px.chunks_mut(width)).zip(visible.chunks_mut(width));
            for (row, ((ids, distances), ((across_px, down_px), visible))) in rows.zip(vectors).enumerate() {
                let y = (band * ROWS + row) as u32;
                let mut row = MotionRow { ids, distances, across_px, down_px, visible };
                on_lanes!(lanes, simd => self.resolve_row(simd, y, &mut row, &mut cache));
            }
        });
        Some(vectors)
    }

    #[inline(always)]
    fn resolve_row<S: Simd>(&self, simd: S, y: u32, row: &mut MotionRow<'_>, cache: &mut Cache) {
        for first in (0..row.ids.len()).step_by(BLOCK) {
            let mut ids = padded(&row.ids[first..], GBuffer::NO_OBJECT);
            let mut block = Block::still(&padded(&row.distances[first..], 0.0));
            let mut start = 0;
            while start < BLOCK {
                let id = ids[start];
                // Most blocks show a single triangle.
                let end = if ids == [id; BLOCK] {
                    BLOCK
                } else {
                    start + ids[start..].iter().take_while(|other| **other == id).count()
                };
                let motion = cache.get(self, id);
                block.set(motion, start..end, (first as u32, y));
                ids[start..end].fill(motion.object);
                start = end;
            }
            store_in(&mut row.ids[first..], &ids);
            store_in(&mut row.across_px[first..], &block.across_px.map(|px| px * self.scale));
            store_in(&mut row.down_px[first..], &block.down_px.map(|px| px * self.scale));
            let Some(before) = self.before else { continue };
            let visible = before.shows_moved(simd, (first as u32, y), &ids, &block);
            store_in(&mut row.visible[first..], &visible);
        }
    }
}

impl Placed<'_> {
    /// Returns the corners of triangle `number` of the mesh: homogeneous pixels, and the distance.
    fn corners(&self, number: usize) -> Option<[DVec4; 3]> {
        let corners = self.mesh.triangles.get(number)?;
        let positions = &self.mesh.positions;
        let [a, b, c] = corners.map(|vertex| positions.get(vertex as usize));
        Some([a?, b?, c?].map(|position| self.px_from_model * position.as_dvec3().extend(1.0)))
    }
}

/// Returns the motion of points at infinity between two cameras. Returns `None` if such points are still, or if a
/// camera is orthographic and shows none.
fn background([now, before]: [&Camera; 2], size: (u32, u32)) -> Option<PlaneMotion> {
    let is_perspective = |camera: &Camera| matches!(camera.projection, Projection::Perspective { .. });
    if now == before || !is_perspective(now) || !is_perspective(before) {
        return None;
    }
    let corners = |camera: &Camera| {
        let px_from_world = px_from_world(camera, size);
        [DVec3::X, DVec3::Y, DVec3::Z].map(|direction| (px_from_world * direction.extend(0.0)).truncate())
    };
    // Distances are infinite; the caller keeps those of the current frame.
    Some(PlaneMotion::new(&MovedTriangle { now: corners(now), before: corners(before), distances: [f64::NAN; 3] }))
}

/// One row of the G-buffer and of the motion vectors.
struct MotionRow<'a> {
    /// Triangle ids, which are replaced by objects.
    ids: &'a mut [Rgba8],
    distances: &'a [f32],
    across_px: &'a mut [f32],
    down_px: &'a mut [f32],
    visible: &'a mut [u8],
}
