//! Marks of changed pixels over a dimmed picture. The marks have a minimum size on the screen, so that a single changed
//! pixel is visible at any scale.

use std::sync::Arc;

use eframe::egui::{Color32, Painter, Rect, Ui, Vec2, pos2, vec2};

use super::picture_texture::PictureTexture;
use super::zoom::Placement;
use crate::image::color::SIGNAL;
use crate::image::{Image, Rgba8};
use crate::inspect::what_if::Changes;

/// Minimum width and height of the mark of a changed pixel, in screen pixels.
const MIN_MARK: f32 = 5.0;

/// Factor for the colours of a picture below the marks.
pub(crate) const DIMMED: Color32 = Color32::from_gray(0x60);

/// Picture of the marks, rebuilt when the changed pixels or their placement on the screen change.
#[derive(Default)]
pub(crate) struct ChangedLayer {
    texture: PictureTexture,
    cached: Option<CachedMarks>,
}

/// Picture of the marks, and the inputs it was drawn from.
struct CachedMarks {
    changes: Arc<Changes>,
    screen: ScreenPlacement,
    marks: Arc<Image<Rgba8>>,
}

/// Placement of a picture on the canvas, in screen pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ScreenPlacement {
    /// Width and height of the canvas.
    canvas: [u32; 2],
    /// Position of the picture's top-left corner relative to the canvas.
    corner: Vec2,
    /// Screen pixels per picture pixel.
    scale: f32,
}

impl ScreenPlacement {
    fn new(ui: &Ui, placement: Placement) -> Self {
        let per_point = ui.pixels_per_point();
        let size = placement.canvas.size() * per_point;
        Self {
            canvas: [size.x, size.y].map(|side| side.ceil().max(1.0) as u32),
            corner: (placement.corner - placement.canvas.min) * per_point,
            scale: placement.points_per_px * per_point,
        }
    }
}

impl ChangedLayer {
    /// Paints the marks. The painter must be clipped to the canvas.
    pub(crate) fn paint(&mut self, ui: &Ui, painter: &Painter, placement: Placement, changes: &Arc<Changes>) {
        let screen = ScreenPlacement::new(ui, placement);
        let fits = |known: &&CachedMarks| Arc::ptr_eq(&known.changes, changes) && known.screen == screen;
        let marks = match self.cached.as_ref().filter(fits) {
            Some(known) => known.marks.clone(),
            None => Arc::new(marks(changes, screen)),
        };
        let texture = self.texture.show(ui, &marks);
        let (width, height) = marks.size();
        let size = vec2(width as f32, height as f32) / ui.pixels_per_point();
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture, Rect::from_min_size(placement.canvas.min, size), uv, Color32::WHITE);
        self.cached = Some(CachedMarks { changes: changes.clone(), screen, marks });
    }
}

/// Draws the marks in screen pixels of the canvas: the signal colour at marks, transparent elsewhere.
fn marks(
    changes: &Changes,
    ScreenPlacement { canvas: [width, height], corner, scale }: ScreenPlacement,
) -> Image<Rgba8> {
    let mut marks = Image::filled(width, height, [0; 4]);
    let (columns, rows) = changes.mask.size();
    let margin = ((MIN_MARK - scale) / 2.0).max(0.0);
    // Screen range of the picture's pixels from `first` up to, but not including, `end`.
    let range = |corner: f32, first: u32, end: u32, most: u32| {
        let from = (corner + first as f32 * scale - margin).round().max(0.0) as u32;
        let to = (corner + end as f32 * scale + margin).round().max(0.0) as u32;
        from.min(most)..to.min(most)
    };
    for row in 0..rows {
        let lines = range(corner.y, row, row + 1, height);
        if lines.is_empty() {
            continue;
        }
        let mut column = 0;
        while column < columns {
            let first = column;
            while column < columns && changes.mask.at(column, row) {
                column += 1;
            }
            if first == column {
                column += 1;
                continue;
            }
            let across = range(corner.x, first, column, width);
            for line in lines.clone() {
                let start = line as usize * width as usize;
                let span = start + across.start as usize..start + across.end as usize;
                marks.pixels_mut()[span].fill(SIGNAL);
            }
        }
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Draws the marks of one changed pixel of a picture with 100 × 100 pixels.
    fn marked((x, y): (u32, u32), screen: ScreenPlacement) -> Vec<(u32, u32)> {
        let picture = |changed: bool| {
            Image::from_fn(100, 100, |column, row| [u8::from(changed && (column, row) == (x, y)), 0, 0, 255])
        };
        let changes = Changes::of_pictures(&picture(false), &picture(true)).unwrap();
        let marks = marks(&changes, screen);
        let all = (0..marks.height()).flat_map(|row| (0..marks.width()).map(move |column| (column, row)));
        all.filter(|(column, row)| marks.at(*column, *row) == SIGNAL).collect()
    }

    #[test]
    fn one_changed_pixel_is_at_least_five_screen_pixels_wide() {
        for scale in [0.1, 0.5, 1.0, 3.0] {
            let screen = ScreenPlacement { canvas: [400, 400], corner: vec2(20.0, 10.0), scale };
            let marks = marked((40, 50), screen);
            let center = (20.0 + 40.5 * scale, 10.0 + 50.5 * scale);
            assert!((25..=36).contains(&marks.len()), "{} pixels at {scale}", marks.len());
            let reach =
                |(x, y): &(u32, u32)| (*x as f32 + 0.5 - center.0).abs().max((*y as f32 + 0.5 - center.1).abs());
            assert!(marks.iter().all(|mark| reach(mark) <= MIN_MARK / 2.0 + 0.5), "{scale}");
        }
    }

    #[test]
    fn an_enlarged_pixel_is_marked_exactly() {
        let screen = ScreenPlacement { canvas: [400, 400], corner: vec2(-100.0, -300.0), scale: 8.0 };
        let marks = marked((40, 50), screen);
        assert_eq!((marks[0], marks.len()), ((220, 100), 64));
    }

    #[test]
    fn marks_outside_the_canvas_are_clipped() {
        let screen = ScreenPlacement { canvas: [30, 30], corner: vec2(0.0, 0.0), scale: 1.0 };
        assert_eq!(marked((0, 0), screen).len(), 9);
        assert_eq!(marked((90, 90), screen).len(), 0);
    }
}
