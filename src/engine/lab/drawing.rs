//! Conversion of a recorded run to vector graphics: dark pixels on white, with the true shape in blue on top.

use std::path::Path;
use std::time::Duration;

use glam::DVec2;

use super::recording::{Ink, InkedPixel, Mark, Recording, Tone};
use crate::drawing::file::{DrawingFileError, DrawingFormat, PixelFormat, encode, encode_animation, format_of, save};
use crate::drawing::{Drawing, Rgb, Shape, Stroke};

const PAPER: Rgb = [255, 255, 255];
const GRID: Rgb = [215, 215, 215];
const FULL: Rgb = [60, 60, 60];
const WALL: Rgb = [130, 100, 70];
const SIDES: [Rgb; 2] = [[250, 226, 205], [210, 228, 250]];

/// Colours of the groups of [`Ink::Group`], chosen to be equally prominent on white.
const GROUPS: [Rgb; 8] = [
    [230, 159, 0],
    [86, 150, 233],
    [0, 158, 115],
    [204, 121, 167],
    [120, 190, 200],
    [190, 200, 60],
    [213, 94, 0],
    [140, 140, 140],
];

/// Width of a drawn line in grid pixels, which is also the unit of the following constants.
const LINE: f64 = 0.12;
const GRID_LINE: f64 = 0.04;
const DOT: f64 = 0.36;
const SMALL_DOT: f64 = 0.12;
const LETTERS: f64 = 0.9;

/// Size of a grid pixel in exported files, in bitmap pixels or, in a PDF, in points.
const SCALE: f64 = 16.0;

/// Maximum number of frames of an animation. Longer runs are sampled at equal step intervals.
const MAX_FRAMES: usize = 150;

/// Duration of each frame of an animation.
const FRAME_TIME: Duration = Duration::from_millis(80);

/// Writes a recording to a file, in the format given by the extension; see [`encode_recording`].
pub fn write_recording(path: &Path, recording: &Recording, steps: usize) -> Result<(), DrawingFileError> {
    save(path, &encode_recording(path, recording, steps)?)
}

/// Encodes the picture after the first `steps` steps of a recording, in the file format given by the extension. A GIF
/// instead animates all steps.
pub fn encode_recording(path: &Path, recording: &Recording, steps: usize) -> Result<Vec<u8>, DrawingFileError> {
    if format_of(path)? != DrawingFormat::Pixels(PixelFormat::Gif) {
        return encode(path, &drawing(recording, steps), SCALE);
    }
    let all = recording.steps.len();
    let frames = all.min(MAX_FRAMES);
    let step = |frame: usize| (frame * all).checked_div(frames).unwrap_or(0);
    encode_animation(path, (0..=frames).map(|frame| drawing(recording, step(frame))), SCALE / 2.0, FRAME_TIME)
}

/// Returns the drawing of a recording after its first `steps` steps; one unit of length is one grid pixel.
pub(crate) fn drawing(recording: &Recording, steps: usize) -> Drawing {
    let (width, height) = recording.size;
    let size = DVec2::new(width.into(), height.into());
    let mut drawing = Drawing { size, background: PAPER, shapes: Vec::new() };
    for (x, y, color) in colored(recording.size, recording.cells(steps)) {
        drawing.square(x as f64, y as f64, 1.0, color);
    }
    drawing.shapes.extend(grid(recording.size));
    drawing.shapes.extend(recording.marks(steps).map(shape_of));
    drawing
}

/// Returns column, row and colour of each pixel that lies in a grid of `size`.
pub(super) fn colored<'a>(
    (width, height): (u32, u32),
    cells: impl Iterator<Item = &'a InkedPixel>,
) -> impl Iterator<Item = (i64, i64, Rgb)> {
    let is_inside =
        move |cell: &&InkedPixel| (0..i64::from(width)).contains(&cell.x) && (0..i64::from(height)).contains(&cell.y);
    cells.filter(is_inside).map(|cell| (cell.x, cell.y, color_of(cell.ink)))
}

/// Returns the lines of a grid of `size`.
pub(super) fn grid((width, height): (u32, u32)) -> impl Iterator<Item = Shape> {
    let line = |from: (f64, f64), to: (f64, f64)| {
        let stroke = Stroke { color: GRID, width: GRID_LINE };
        Shape::Line { from: from.into(), to: to.into(), stroke }
    };
    let columns = (0..=width).map(move |x| line((x.into(), 0.0), (x.into(), height.into())));
    columns.chain((0..=height).map(move |y| line((0.0, y.into()), (width.into(), y.into()))))
}

fn color_of(ink: Ink) -> Rgb {
    match ink {
        Ink::Full => FULL,
        Ink::Share(share) => std::array::from_fn(|channel| {
            let (paper, full) = (f64::from(PAPER[channel]), f64::from(FULL[channel]));
            (paper + (full - paper) * share).round() as u8
        }),
        Ink::Wall => WALL,
        Ink::Group(number) => GROUPS[number % GROUPS.len()],
        Ink::Side(positive) => SIDES[usize::from(positive)],
        Ink::Color(color) => color,
    }
}

fn color_of_tone(tone: Tone) -> Rgb {
    match tone {
        Tone::Ideal => [10, 90, 200],
        Tone::Weak => [150, 150, 150],
        Tone::Focus => [200, 30, 40],
        Tone::A => [98, 75, 216],
        Tone::B => [200, 110, 0],
    }
}

/// Returns the shape of a mark.
pub(super) fn shape_of(mark: &Mark) -> Shape {
    let stroke = |tone: &Tone| Stroke { color: color_of_tone(*tone), width: LINE };
    match mark {
        Mark::Line(from, to, tone) => Shape::Line { from: *from, to: *to, stroke: stroke(tone) },
        Mark::Outline(corners, tone) => {
            Shape::Polygon { corners: corners.clone(), fill: None, stroke: Some(stroke(tone)) }
        }
        Mark::Ellipse(center, radii, tone) => {
            Shape::Ellipse { center: *center, radii: *radii, fill: None, stroke: Some(stroke(tone)) }
        }
        Mark::Dot(at, tone) => Shape::Ellipse {
            center: *at,
            radii: DVec2::splat(if *tone == Tone::Weak { SMALL_DOT } else { DOT } / 2.0),
            fill: Some(color_of_tone(*tone)),
            stroke: None,
        },
        Mark::Text(at, text, tone) => {
            Shape::Text { at: *at, text: text.clone(), color: color_of_tone(*tone), size: LETTERS }
        }
    }
}
