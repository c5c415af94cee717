//! Temporal checkerboard rendering: alternate frames draw alternate squares.
//!
//! The pixels missing in this frame were drawn in the previous one. In a still view they are copied, so that the image
//! is bit-identical to native rendering from the second frame on. In motion, a missing pixel is reprojected into the
//! previous frame by its motion vector. If the previous frame shows the same surface there, its colour is used, clamped
//! to the minimum and maximum of the surrounding drawn pixels. Otherwise the pixel is interpolated from neighbours that
//! show the same surface in this frame.

use super::squares::{self, DrawnNeighbours, Fill, MissingRun, channel, pixels};
use super::surfaces::SurfaceFill;
use super::{OFFERS, PixelPosition, around, surfaces};
use crate::image::{Image, Rgba8};
use crate::math::lanes::*;
use crate::pipeline::grid::SampleGrid;
use crate::pipeline::motion::MotionVectors;
use crate::upscale::history::NOT_VISIBLE;
use crate::upscale::{
    BlendSpace, CENTRE, FilterSpace, HistoryStep, HistorySteps, Motion, Offers, PastColor, Reads, Rejection,
    Reprojected, Sampling, Tap, UpscaleInputs, Upscaler, Upscaling,
};

/// Checkerboard rendering with missing pixels reprojected from the previous frame.
pub(crate) static CHECKERBOARD_TEMPORAL: CheckerboardTemporal = CheckerboardTemporal;

/// [`Upscaler`] implementation of [`CHECKERBOARD_TEMPORAL`].
pub(crate) struct CheckerboardTemporal;

impl Upscaler for CheckerboardTemporal {
    fn id(&self) -> &'static str {
        "checkerboard-temporal"
    }

    fn name(&self) -> &'static str {
        "Checkerboard, temporal"
    }

    fn help(&self) -> &'static str {
        "Draws the squares of one colour of a checkerboard in one frame and the others in the next; missing pixels are \
         reprojected from the previous frame. In a still view the picture equals native rendering from the second \
         frame on, bit for bit. In motion, disoccluded pixels are only interpolated from their neighbours, and light \
         that moves over a surface lags. Used by many console games (Rainbow Six Siege, 2015)."
    }

    fn artefacts(&self) -> &'static str {
        "disoccluded areas are interpolated, moving light lags"
    }

    fn offers(&self) -> Offers {
        OFFERS
    }

    fn reads(&self) -> Reads {
        Reads { gbuffer: true, history: true }
    }

    fn converges_after(&self, _how: Upscaling) -> u32 {
        2
    }

    fn sampling(&self, _how: Upscaling) -> Sampling {
        Sampling::Grid(grid(0))
    }

    fn frame_sampling(&self, _how: Upscaling, frames: u32) -> (Sampling, [f64; 2]) {
        (Sampling::Grid(grid(frames)), CENTRE)
    }

    fn upscale(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, full: &mut Image<Rgba8>) {
        let by = TemporalFill::new(drawn, full.size());
        squares::fill(Lanes::best(), grid_of(drawn), drawn.color, full, &by);
    }

    fn pixel(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        filled(drawn, motion(drawn).as_ref(), size, at)
    }

    /// Returns the samples of this frame only; history contributes no taps.
    fn taps(&self, _how: Upscaling, drawn: &UpscaleInputs<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        let mut taps = surfaces::taps(grid_of(drawn), drawn, size, at).to_vec();
        // Surrounding samples clamp the history, so they are listed with zero weight.
        for (x, y) in around(size, at).filter(|_| grid_of(drawn).sample_at(at.0, at.1).is_none()) {
            if taps.iter().all(|tap| (tap.x, tap.y) != (x, y)) {
                taps.push(Tap { x, y, weight: 0.0 });
            }
        }
        taps
    }

    fn history_steps<'a>(&'a self, _how: Upscaling, drawn: &'a UpscaleInputs<'a>) -> HistorySteps<'a> {
        Box::new(|at| history_step(drawn, at))
    }
}

/// Returns how a pixel is filled in from its history; `None` if this frame draws the pixel.
fn history_step(drawn: &UpscaleInputs<'_>, at: (u32, u32)) -> Option<HistoryStep> {
    if grid_of(drawn).sample_at(at.0, at.1).is_some() {
        return None;
    }
    let frame = drawn.frame?;
    let size = frame.size;
    let numbers = |[r, g, b, _]: Rgba8| [r, g, b].map(f32::from);
    let present = numbers(surfaces::filled(grid_of(drawn), drawn, size, at));
    let past = frame.reproject(at).and_then(|before| {
        let (read, clamped) = motion(drawn)
            .and_then(|motion| reprojected_color(drawn, &motion, size, at, &before))
            .ok_or(Rejection::Outside)?;
        Ok(PastColor { position_px: before.place, read: numbers(read), rectified: numbers(clamped) })
    });
    let share = if past.is_ok() { 0.0 } else { 1.0 };
    Some(HistoryStep { space: BlendSpace::Rgb(FilterSpace::Bytes), present, share, past })
}

/// Returns which half of the squares to draw after `frames` earlier frames.
fn grid(frames: u32) -> SampleGrid {
    if frames.is_multiple_of(2) { SampleGrid::Checkerboard } else { SampleGrid::OddCheckerboard }
}

pub(super) fn grid_of(drawn: &UpscaleInputs<'_>) -> SampleGrid {
    grid(drawn.frame.map_or(0, |seen| seen.frames()))
}

fn motion<'a>(drawn: &UpscaleInputs<'a>) -> Option<Motion<'a>> {
    drawn.frame.and_then(|seen| seen.reprojection())
}

fn filled(drawn: &UpscaleInputs<'_>, motion: Option<&Motion<'_>>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
    let grid = grid_of(drawn);
    if let Some((column, row)) = grid.sample_at(at.0, at.1) {
        return drawn.color.at(column, row);
    }
    motion
        .and_then(|motion| reproject_pixel(drawn, motion, size, at))
        .unwrap_or_else(|| surfaces::filled(grid, drawn, size, at))
}

/// Kernel that reprojects missing pixels from the previous frame. Pixels without valid history are interpolated from
/// neighbours that show the same surface in this frame.
pub(super) struct TemporalFill<'a> {
    fallback: SurfaceFill<'a>,
    motion: Option<Motion<'a>>,
}

impl Fill for TemporalFill<'_> {
    fn pixel(&self, at: PixelPosition) -> Rgba8 {
        filled(self.fallback.drawn, self.motion.as_ref(), self.fallback.size, at)
    }

    #[inline(always)]
    fn missing<S: Simd>(&self, simd: S, run: &MissingRun, around: DrawnNeighbours<S>) -> u32x16<S> {
        let past = self.motion.as_ref().and_then(|motion| Some((motion, motion.history.picture.as_ref()?)));
        let Some((motion, picture)) = past else { return self.fallback.missing(simd, run, around) };
        let Some(vectors) = motion.vectors else { return run.own(simd, picture.row(run.y)) };
        let (known, remembered) = reproject_pixels(simd, vectors, picture, run, around);
        if known.all_true() {
            return remembered;
        }
        known.select(remembered, self.fallback.missing(simd, run, around))
    }
}

impl<'a> TemporalFill<'a> {
    pub(super) fn new(drawn: &'a UpscaleInputs<'a>, size: (u32, u32)) -> Self {
        Self { fallback: SurfaceFill { grid: grid_of(drawn), drawn, size }, motion: motion(drawn) }
    }
}

/// Reprojects 16 missing pixels, each like [`reproject_pixel`]. Returns a mask of the pixels with valid history, and 16
/// colours. Only the colours of these pixels are meaningful.
#[inline(always)]
fn reproject_pixels<S: Simd>(
    simd: S,
    vectors: &MotionVectors,
    picture: &Image<Rgba8>,
    run: &MissingRun,
    around: DrawnNeighbours<S>,
) -> (mask32x16<S>, u32x16<S>) {
    let [first, last] = run.vectors(simd, vectors);
    let [a, b] = each!(part in [first, last] => part.reproject(simd, vectors.visible.size()));
    let upper = a.upper.combine(b.upper);
    let known = upper.simd_ne(u32x16::splat(simd, NOT_VISIBLE));
    let upper = known.select(upper, u32x16::splat(simd, 0));
    let lower = known.select(a.lower.combine(b.lower), u32x16::splat(simd, 0));
    let step = known.select(a.step.combine(b.step), u32x16::splat(simd, 0));
    let (right, down) = (a.right.combine(b.right), a.down.combine(b.down));
    let [a, b, c, d] = each!(at in [upper, upper + step, lower, lower + step] => {
        gathered(simd, picture.pixels(), at)
    });
    let DrawnNeighbours { beside, across, far_beside, far_across } = around;
    let [beside, across, far_beside, far_across] =
        each!(words in [beside, across, far_beside, far_across] => words.bitcast::<u8x64<S>>());
    let least = beside.min(across).min(far_beside.min(far_across));
    let greatest = beside.max(across).max(far_beside.max(far_across));
    let codes = pixels(each!(index in [0, 1, 2, 3] => {
        let [a, b, c, d] = each!(words in [a, b, c, d] => channel(words, index));
        let (above, below) = (a + (b - a) * right, c + (d - c) * right);
        (above + (below - above) * down) + 0.5
    }));
    (known, codes.bitcast::<u8x64<S>>().max(least).min(greatest).bitcast())
}

/// Gathers 16 pixels of an image by index.
#[inline(always)]
fn gathered<S: Simd>(simd: S, of: &[Rgba8], at: u32x16<S>) -> u32x16<S> {
    let (at, mut words) = (at.to_array(), [0; WIDE]);
    for lane in 0..WIDE {
        words[lane] = u32::from_le_bytes(of[at[lane] as usize]);
    }
    u32x16::load_array(simd, words)
}

/// Returns the reprojected colour of a missing pixel, if the previous frame shows the same surface.
fn reproject_pixel(drawn: &UpscaleInputs<'_>, motion: &Motion<'_>, size: (u32, u32), at: (u32, u32)) -> Option<Rgba8> {
    let before = motion.reproject_by(at, at).ok()?;
    Some(reprojected_color(drawn, motion, size, at, &before)?.1)
}

/// Returns the colour of the previous frame at the reprojected position of a missing pixel, and the same colour clamped
/// to the drawn pixels around it.
fn reprojected_color(
    drawn: &UpscaleInputs<'_>,
    motion: &Motion<'_>,
    size: (u32, u32),
    at: (u32, u32),
    before: &Reprojected,
) -> Option<(Rgba8, Rgba8)> {
    let picture = motion.history.picture.as_ref()?;
    if before.is_still {
        return Some((picture.at(at.0, at.1), picture.at(at.0, at.1)));
    }
    let [mut least, mut greatest] = [[u8::MAX; 4], [u8::MIN; 4]];
    for (x, y) in around(size, at) {
        let (column, row) = grid_of(drawn).sample_at(x, y)?;
        for (channel, code) in drawn.color.at(column, row).into_iter().enumerate() {
            least[channel] = least[channel].min(code);
            greatest[channel] = greatest[channel].max(code);
        }
    }
    let color = before.read(size, |x, y| picture.at(x, y).map(f32::from));
    let read = color.map(|code| (code + 0.5) as u8);
    Some((read, std::array::from_fn(|channel| read[channel].max(least[channel]).min(greatest[channel]))))
}
