//! Inputs of upscalers besides the drawn colours: the visible object and its distance in every pixel, its motion, and
//! the previous frame.

use std::sync::Arc;

use serde::Serialize;

use super::{FilterSpace, Sampling};
use crate::image::color::Tables;
use crate::image::{Image, Rgba8};
use crate::pipeline::gbuffer::GBuffer;
use crate::pipeline::motion::{FrameView, MotionVectors};
use crate::pipeline::settings::{Choice, choice};
use crate::scene::{Camera, Scene};

mod dilated;
mod filter;
mod surface_grid;
mod wide;
mod window;

pub(super) use dilated::DilatedVectors;
pub(super) use filter::FilterWeights;
pub(super) use surface_grid::{Around, SurfaceGrid};
pub(super) use wide::{NOT_VISIBLE, SurfaceLanes, VectorLanes};
pub(super) use window::{PastPlaces, centers};

/// History that an upscaler stores for its next frame, at full resolution.
#[derive(Clone, Debug, PartialEq)]
pub struct Accumulated {
    /// Four numbers per pixel: usually the colour in the upscaler's working space, and its accumulated weight.
    pub color: Image<[f32; 4]>,
    /// Locks, which protect pixels from rectification: two numbers per pixel. `None` if the upscaler has none.
    pub locks: Option<Image<[f32; 2]>>,
}

impl Accumulated {
    /// Returns a history of `width` × `height` px without locks, with arbitrary colours, in the buffer of `spare`.
    pub(in crate::upscale) fn reusing(spare: Option<Self>, (width, height): (u32, u32)) -> Self {
        Self { color: Image::reusing(spare.map(|spare| spare.color), width, height, [0.0; 4]), locks: None }
    }

    /// Returns a history of `width` × `height` px with arbitrary colours and locks, in the buffers of `spare`.
    pub(in crate::upscale) fn with_locks_reusing(spare: Option<Self>, (width, height): (u32, u32)) -> Self {
        let (color, locks) = spare.map_or((None, None), |spare| (Some(spare.color), spare.locks));
        Self {
            color: Image::reusing(color, width, height, [0.0; 4]),
            locks: Some(Image::reusing(locks, width, height, [0.0; 2])),
        }
    }

    /// Returns the memory use in bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.color.bytes() + self.locks.as_ref().map_or(0, Image::bytes)
    }
}

/// Previous frame, as read by upscalers with history.
#[derive(Clone, Debug)]
pub struct History {
    /// Full image of the frame; `None` if the upscaler stores its own history.
    pub(crate) picture: Option<Image<Rgba8>>,
    /// The upscaler's own history, with higher precision than the image.
    pub(crate) accumulated: Option<Accumulated>,
    /// Visible surfaces of the previous frame.
    pub(crate) surfaces: Arc<GBuffer>,
    /// Scene at the time of the previous frame.
    pub(crate) scene: Arc<Scene>,
    /// Camera of the previous frame.
    pub(crate) camera: Camera,
    /// Number of frames before the previous frame that belong to the same history.
    pub(crate) frames: u32,
    /// Number of consecutive frames with unchanged camera and scene, up to and including the previous frame.
    pub(crate) still_frames: u32,
}

impl History {
    /// Returns the view of the previous frame.
    pub(crate) fn view(&self) -> FrameView<'_> {
        FrameView { scene: &self.scene, camera: &self.camera }
    }

    /// Returns the memory use of the buffers in bytes.
    pub(crate) fn buffer_bytes(&self) -> usize {
        self.picture.as_ref().map_or(0, Image::bytes)
            + self.accumulated.as_ref().map_or(0, Accumulated::bytes)
            + self.surfaces.object.bytes()
            + self.surfaces.distance.bytes()
    }

    /// Whether a view has the camera and the scene of the previous frame.
    pub(crate) fn shows(&self, view: FrameView<'_>) -> bool {
        self.camera == *view.camera && std::ptr::eq(&*self.scene, view.scene)
    }
}

/// Inputs of the current frame besides its colours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameInputs<'a> {
    /// Size of the full picture, in pixels.
    pub(crate) size: (u32, u32),
    /// Samples that the frame draws. The G-buffer has one pixel per sample if they are a lattice; otherwise, it has all
    /// pixels of the full picture.
    pub(crate) sampling: Sampling,
    /// Visible surfaces of the current frame.
    pub(crate) gbuffer: &'a GBuffer,
    /// Motion since the previous frame; `None` if camera and scene are still.
    pub(crate) motion: Option<&'a MotionVectors>,
    /// Previous frame, if it shows a pose of the same scene with the same recipe.
    pub(crate) history: Option<&'a History>,
    /// Reactivity of every instance, in [0, 1]: the share by which its history counts less. `None` if it is 0 for all
    /// instances, or if the upscaler does not read it.
    pub(crate) reactivity: Option<&'a [f32]>,
}

impl FrameInputs<'_> {
    /// Returns the number of earlier frames in the history of the current one.
    pub(crate) fn frames(&self) -> u32 {
        self.history.map_or(0, |past| past.frames + 1)
    }

    /// Reprojects pixel `at` into the previous frame. Returns an error if that frame does not show the pixel's surface,
    /// or if there is no previous frame.
    pub(crate) fn reproject(&self, at: (u32, u32)) -> Result<Reprojected, Rejection> {
        self.reprojection().ok_or(Rejection::FirstFrame)?.reproject_by(at, self.surface_grid().nearest(at))
    }

    /// Returns the positions of the pixels of the G-buffer in the full picture.
    #[inline(always)]
    pub(in crate::upscale) fn surface_grid(&self) -> SurfaceGrid {
        SurfaceGrid::new(self.sampling, self.gbuffer.object.size())
    }

    /// Reprojects pixel `at` into the previous frame like [`Self::reproject`], but with the vector of the nearest of the
    /// surfaces around it; see [`DilatedVectors`].
    #[inline(always)]
    pub(in crate::upscale) fn reproject_dilated(&self, at: (u32, u32)) -> Result<Reprojected, Rejection> {
        let motion = self.reprojection().ok_or(Rejection::FirstFrame)?;
        motion.reproject_by(at, self.surface_grid().nearest_surface(self.gbuffer, at))
    }
}

/// Blending of a pixel with its history. Colours are three numbers in the space in which the upscaler blends.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HistoryStep {
    /// Space of the colours.
    pub space: BlendSpace,
    /// Colour of the pixel from the samples of this frame alone.
    pub present: [f32; 3],
    /// Share of this frame in the pixel, in [0, 1]; 1 if the history is rejected.
    pub share: f32,
    /// History of the pixel, or the reason why it is rejected.
    pub past: Result<PastColor, Rejection>,
}

/// History of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PastColor {
    /// Position in the previous frame, in pixels from the top left corner.
    pub position_px: [f32; 2],
    /// Colour that the history has there.
    pub read: [f32; 3],
    /// Colour after rectification by the samples of this frame.
    pub rectified: [f32; 3],
}

/// Filter with which an upscaler reads its history between pixels, along one axis. Pixel 0 is the last one whose centre
/// does not lie behind the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HistoryTaps {
    /// Linear interpolation a + (b − a) · t of pixels 0 and 1, with t in [0, 1): first along the rows, then between them.
    Linear(f32),
    /// Weighted sum of pixels −1 to 2: first along the columns, then (a + c) + (b + d) between them.
    Four([f32; 4]),
    /// Like [`HistoryTaps::Four`]. The result is then clamped to the range of the nearest 2 × 2 pixels.
    FourClamped([f32; 4]),
}

/// Function that returns how pixels of one frame are blended with their history; see [`Upscaler::history_steps`].
///
/// [`Upscaler::history_steps`]: super::Upscaler::history_steps
pub type HistorySteps<'a> = Box<dyn Fn((u32, u32)) -> Option<HistoryStep> + Sync + 'a>;

impl HistoryStep {
    /// Returns the colour of the pixel before it is encoded, with the arithmetic of the upscaler.
    pub fn blended(&self) -> [f32; 3] {
        match &self.past {
            Ok(past) => std::array::from_fn(|i| past.rectified[i] + (self.present[i] - past.rectified[i]) * self.share),
            Err(_) => self.present,
        }
    }

    /// Returns the sRGB codes of the pixel.
    pub fn codes(&self) -> [u8; 3] {
        self.encoded(self.blended())
    }

    /// Returns the sRGB codes of a colour in the space of this step.
    pub(crate) fn encoded(&self, color: [f32; 3]) -> [u8; 3] {
        self.space.encoded(Tables::get(), color)
    }
}

/// Space in which an upscaler blends colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum BlendSpace {
    /// Red, green and blue.
    Rgb(FilterSpace),
    /// Luminance and chroma: Y = (R + 2 G + B) / 4, Co = (R − B) / 2, Cg = (2 G − R − B) / 4.
    YCoCg(FilterSpace),
}

impl BlendSpace {
    /// Returns the names of the three numbers of a colour.
    pub fn components(self) -> [&'static str; 3] {
        match self {
            Self::Rgb(_) => ["R", "G", "B"],
            Self::YCoCg(_) => ["Y", "Co", "Cg"],
        }
    }

    /// Returns the sRGB codes of a colour.
    #[inline(always)]
    pub(crate) fn encoded(self, tables: &Tables, [a, b, c]: [f32; 3]) -> [u8; 3] {
        let (light, rgb) = match self {
            Self::Rgb(light) => (light, [a, b, c]),
            Self::YCoCg(light) => (light, [a - c + b, a + c, a - c - b]),
        };
        rgb.map(|value| match light {
            FilterSpace::Linear => tables.encode(value),
            FilterSpace::Bytes => (value + 0.5) as u8,
        })
    }
}

choice! {
    /// Reason why a pixel has no history.
    pub Rejection {
        FirstFrame = "first-frame", "First frame", "there is no previous frame";
        Outside = "outside", "Outside", "the surface was outside the picture of the previous frame";
        Disoccluded = "disoccluded", "Disoccluded", "the previous frame does not show the surface whose motion the pixel follows";
    }
}

impl<'a> FrameInputs<'a> {
    /// Returns the motion since the previous frame, or `None` if there is no previous frame.
    pub(crate) fn reprojection(&self) -> Option<Motion<'a>> {
        Some(Motion { history: self.history?, vectors: self.motion, size: self.size })
    }
}

/// Motion since the previous frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<'a> {
    /// Previous frame, into which pixels are reprojected.
    pub(crate) history: &'a History,
    /// Motion of every pixel of the G-buffer; `None` if camera and scene are still.
    pub(crate) vectors: Option<&'a MotionVectors>,
    /// Size of the full picture, in pixels.
    size: (u32, u32),
}

impl Motion<'_> {
    /// Whether camera and scene are unchanged, so that every pixel maps to itself.
    pub(in crate::upscale) fn is_still(&self) -> bool {
        self.vectors.is_none()
    }

    /// Reprojects pixel `at` by the motion vector of pixel `by` of the G-buffer. Returns an error if the position is outside
    /// the previous frame, or if that frame does not show the surface of `by`.
    #[inline(always)]
    pub(crate) fn reproject_by(&self, at: (u32, u32), by: (u32, u32)) -> Result<Reprojected, Rejection> {
        let center = [at.0 as f32 + 0.5, at.1 as f32 + 0.5];
        let Some(vectors) = self.vectors else {
            return Ok(Reprojected { place: center, is_still: true });
        };
        let place = [center[0] + vectors.across_px.at(by.0, by.1), center[1] + vectors.down_px.at(by.0, by.1)];
        let (width, height) = self.size;
        // NaN fails every comparison, so it is not inside.
        let is_inside = place[0] >= 0.0 && place[1] >= 0.0 && place[0] < width as f32 && place[1] < height as f32;
        if !is_inside {
            return Err(Rejection::Outside);
        }
        let is_visible = vectors.visible.at(by.0, by.1) == MotionVectors::VISIBLE;
        is_visible.then_some(Reprojected { place, is_still: false }).ok_or(Rejection::Disoccluded)
    }
}

/// Returns the index of the pixel whose centre lies at or before a position along an axis, and the distance from it, in
/// [0, 1).
#[inline(always)]
pub(crate) fn whole_and_fraction(place: f32) -> (i64, f32) {
    let from = place - 0.5;
    let floor = from.floor();
    (floor as i64, from - floor)
}

/// Position of a pixel in the previous frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Reprojected {
    /// Position in pixels from the top left corner of the image.
    pub(crate) place: [f32; 2],
    /// Whether camera and scene are unchanged, so that the position is the centre of the same pixel.
    pub(crate) is_still: bool,
}

impl Reprojected {
    /// Samples an image bilinearly at this position; reads the pixel itself if camera and scene are unchanged.
    pub(crate) fn read<const N: usize>(&self, size: (u32, u32), value: impl Fn(u32, u32) -> [f32; N]) -> [f32; N] {
        let [x, y] = self.place;
        if self.is_still {
            return value(x as u32, y as u32);
        }
        let axis = |at: f32, length: u32| {
            let (floor, last) = ((at - 0.5).floor(), (length - 1) as f32);
            let pixel = |at: f32| at.clamp(0.0, last) as u32;
            ([pixel(floor), pixel(floor + 1.0)], at - 0.5 - floor)
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

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scene::builtin;
    use crate::upscale::Upscaling;

    /// Inputs of one test frame, with its history.
    pub(in crate::upscale) struct Frames {
        size: (u32, u32),
        sampling: Sampling,
        surfaces: GBuffer,
        motion: Option<MotionVectors>,
        past: Option<History>,
    }

    impl Frames {
        pub(in crate::upscale) fn seen(&self) -> FrameInputs<'_> {
            FrameInputs {
                size: self.size,
                sampling: self.sampling,
                gbuffer: &self.surfaces,
                motion: self.motion.as_ref(),
                history: self.past.as_ref(),
                reactivity: None,
            }
        }
    }

    /// Returns test frames of a few slanted objects at different distances and an empty background, with history after
    /// `number` frames. The first has no history, and the second is still. In the others, samples move by up to the given
    /// distance, and some are disoccluded.
    pub(in crate::upscale) fn frames(how: Upscaling, (width, height): (u32, u32), number: u32) -> Vec<Frames> {
        let mut random = fastrand::Rng::with_seed(u64::from(number));
        let sampling = how.upscaler().frame_sampling(how, number + 1).0;
        let (columns, rows) = sampling.raster_size(width, height);
        let surfaces = GBuffer {
            object: Image::from_fn(columns, rows, |x, y| [(x / 23) as u8, (y / 4) as u8, 0, 255]),
            distance: Image::from_fn(columns, rows, |x, y| {
                if x / 23 == 1 { f32::INFINITY } else { 4.0 + (x / 23) as f32 * 0.3 + y as f32 * 0.01 }
            }),
        };
        let picture = Image::from_fn(width, height, |_, _| std::array::from_fn(|_| random.u8(..)));
        let color =
            Image::from_fn(width, height, |_, _| [random.f32(), random.f32(), random.f32(), 1.0 + 20.0 * random.f32()]);
        let locks = Image::from_fn(width, height, |_, _| [random.f32(), random.f32()]);
        let scene = Arc::new(builtin::ALL[0].build());
        let past = History {
            picture: Some(picture),
            accumulated: Some(Accumulated { color, locks: Some(locks) }),
            surfaces: Arc::new(surfaces.clone()),
            camera: scene.home,
            scene,
            frames: number,
            still_frames: 1,
        };
        let mut moving = |distance_px: f32| {
            let mut by = || Image::from_fn(columns, rows, |_, _| (2.0 * random.f32() - 1.0) * distance_px);
            let (across_px, down_px) = (by(), by());
            let visible =
                Image::from_fn(columns, rows, |_, _| if random.u32(0..8) > 0 { MotionVectors::VISIBLE } else { 0 });
            MotionVectors { across_px, down_px, visible }
        };
        let size = (width, height);
        let frame = |motion, past| Frames { size, sampling, surfaces: surfaces.clone(), motion, past };
        let moved = [0.0, 0.4, 3.0, 40.0].map(|distance_px| frame(Some(moving(distance_px)), Some(past.clone())));
        [frame(None, None), frame(None, Some(past.clone()))].into_iter().chain(moved).collect()
    }

    #[test]
    fn history_is_sampled_bilinearly_at_the_reprojected_position() {
        let value = |x: u32, y: u32| [x as f32 + 10.0 * y as f32];
        let read = |place: [f32; 2]| Reprojected { place, is_still: false }.read((4, 3), value);
        assert_eq!(read([1.5, 1.5]), [11.0], "a pixel centre");
        assert_eq!(read([2.0, 1.5]), [11.5]);
        assert_eq!(read([1.5, 1.75]), [13.5]);
        assert_eq!(read([0.0, 0.0]), [0.0], "the border is repeated");
        assert_eq!(read([3.9, 2.9]), [23.0]);
    }
}
