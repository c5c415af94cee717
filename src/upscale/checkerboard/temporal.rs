//! The checkerboard that draws one colour of squares in one frame and the other colour in the next.
//!
//! What is missing now was drawn a moment ago. Where the view has not moved it is taken over as it was, so that after two
//! frames the picture is the native one, bit for bit. Where it has moved, the place of the missing pixel in the frame before
//! is found by its distance; if that showed the same surface, its colour there, kept between the least and the greatest of
//! the drawn pixels around, is taken; else the pixel is filled from the same surface of this frame.

use super::{OFFERS, around, surfaces};
use crate::image::{Image, Rgba8};
use crate::pipeline::grid::SampleGrid;
use crate::upscale::{Before, CENTRE, Drawn, Motion, Offers, Reads, Sampling, Tap, Upscaler, Upscaling, bands};

/// Missing squares of a checkerboard, taken from the frame before.
pub static CHECKERBOARD_TEMPORAL: CheckerboardTemporal = CheckerboardTemporal;

/// See [`CHECKERBOARD_TEMPORAL`].
pub struct CheckerboardTemporal;

impl Upscaler for CheckerboardTemporal {
    fn id(&self) -> &'static str {
        "checkerboard-temporal"
    }

    fn name(&self) -> &'static str {
        "Checkerboard, temporal"
    }

    fn help(&self) -> &'static str {
        "Draws the squares of one colour of a checkerboard in one frame and the others in the next; what is missing is \
         looked up where the frame before showed it. While the view stands still the picture is native from the second \
         frame on, bit for bit. In motion, what comes out from behind something is only filled from its neighbours, and \
         light that moves over a surface lags. The way of many console games (Rainbow Six Siege, 2015)."
    }

    fn offers(&self) -> Offers {
        OFFERS
    }

    fn reads(&self) -> Reads {
        Reads { surfaces: true, past: true }
    }

    fn settles_after(&self, _how: Upscaling) -> u32 {
        2
    }

    fn sampling(&self, _how: Upscaling) -> Sampling {
        Sampling::Grid(grid(0))
    }

    fn sampling_of(&self, _how: Upscaling, frames: u32) -> (Sampling, [f64; 2]) {
        (Sampling::Grid(grid(frames)), CENTRE)
    }

    fn upscale(&self, _how: Upscaling, drawn: &Drawn<'_>, full: &mut Image<Rgba8>) {
        let size = full.size();
        let motion = motion(drawn, size);
        bands::fill_pixels(full, |at| filled(drawn, motion.as_ref(), size, at));
    }

    fn pixel(&self, _how: Upscaling, drawn: &Drawn<'_>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
        filled(drawn, motion(drawn, size).as_ref(), size, at)
    }

    /// The samples of this frame; what the frame before adds is no sample.
    fn taps(&self, _how: Upscaling, drawn: &Drawn<'_>, size: (u32, u32), at: (u32, u32)) -> Vec<Tap> {
        let mut taps = surfaces::taps(grid_of(drawn), drawn, size, at).to_vec();
        // They bound what comes from the frame before.
        for (x, y) in around(size, at).filter(|_| grid_of(drawn).sample_at(at.0, at.1).is_none()) {
            if taps.iter().all(|tap| (tap.x, tap.y) != (x, y)) {
                taps.push(Tap { x, y, weight: 0.0 });
            }
        }
        taps
    }

    fn remembers(&self, _how: Upscaling, drawn: &Drawn<'_>, size: (u32, u32), at: (u32, u32)) -> Option<Before> {
        let missing = grid_of(drawn).sample_at(at.0, at.1).is_none();
        drawn.seen.filter(|_| missing).and_then(|seen| seen.before(size, at))
    }
}

/// The squares that are drawn when so many frames came before.
fn grid(frames: u32) -> SampleGrid {
    if frames.is_multiple_of(2) { SampleGrid::Checkerboard } else { SampleGrid::OddCheckerboard }
}

fn grid_of(drawn: &Drawn<'_>) -> SampleGrid {
    grid(drawn.seen.map_or(0, |seen| seen.frames()))
}

fn motion<'a>(drawn: &Drawn<'a>, size: (u32, u32)) -> Option<Motion<'a>> {
    drawn.seen.and_then(|seen| seen.motion(size))
}

fn filled(drawn: &Drawn<'_>, motion: Option<&Motion<'_>>, size: (u32, u32), at: (u32, u32)) -> Rgba8 {
    let grid = grid_of(drawn);
    if let Some((column, row)) = grid.sample_at(at.0, at.1) {
        return drawn.color.at(column, row);
    }
    motion
        .and_then(|motion| remembered(drawn, motion, size, at))
        .unwrap_or_else(|| surfaces::filled(grid, drawn, size, at))
}

/// What the frame before tells of a missing pixel, if it showed the same surface.
fn remembered(drawn: &Drawn<'_>, motion: &Motion<'_>, size: (u32, u32), at: (u32, u32)) -> Option<Rgba8> {
    let past = motion.past;
    let before = motion.before(at)?;
    if before.is_still {
        return Some(past.picture.at(at.0, at.1));
    }
    let [mut least, mut greatest] = [[u8::MAX; 4], [u8::MIN; 4]];
    for (x, y) in around(size, at) {
        let (column, row) = grid_of(drawn).sample_at(x, y)?;
        for (channel, code) in drawn.color.at(column, row).into_iter().enumerate() {
            least[channel] = least[channel].min(code);
            greatest[channel] = greatest[channel].max(code);
        }
    }
    let color = before.read(size, |x, y| past.picture.at(x, y).map(f32::from));
    let clamped = |channel: usize| ((color[channel] + 0.5) as u8).max(least[channel]).min(greatest[channel]);
    Some(std::array::from_fn(clamped))
}
