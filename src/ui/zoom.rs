//! Placement of a picture in a rectangle of the window: fitted, or zoomed at the pointer and panned.
//!
//! A picture that is strongly enlarged, or fitted without shrinking, has an integer scale: all its pixels have equal
//! size. Rectangles of the same size that share a [`Zoom`] show the same part of their pictures.

use eframe::egui::{Pos2, Rect, Response, Ui, Vec2, pos2, vec2};

/// Minimum and maximum scale, in screen pixels per picture pixel.
const SCALE_RANGE: (f32, f32) = (1.0 / 32.0, 256.0);

/// Minimum scale of a fitted picture, which prevents division by zero on a canvas without height.
const MIN_FIT: f32 = 1.0 / 65_536.0;

/// Scale at and above which zooming rounds to an integer, in screen pixels per picture pixel.
const WHOLE_FROM: f32 = 8.0;

/// Minimum scale for bringing a pixel into view, in screen pixels per picture pixel. It is large enough to tell the
/// pixel from its neighbours and to see the slope of an edge.
const SEEN_FROM: f32 = 16.0;

/// Scale and position of a picture in a rectangle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Zoom {
    /// Screen pixels per picture pixel; `None` fits the picture into the rectangle.
    scale: Option<f32>,
    /// Scale after the last zoom, before it was rounded to an integer. Small wheel steps accumulate in it.
    wheeled: f32,
    /// Position of the rectangle's top-left corner in the picture, in picture pixels.
    origin: Vec2,
}

/// Placement of a picture in the current frame of the window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    /// Rectangle that shows the picture, in points.
    pub(crate) canvas: Rect,
    /// Scale, in points per picture pixel.
    pub(crate) points_per_px: f32,
    /// Top-left corner of the picture, in points.
    pub(crate) corner: Pos2,
}

impl Placement {
    /// Converts a position in the window from points to picture pixels.
    pub(crate) fn to_picture(self, position: Pos2) -> Vec2 {
        (position - self.corner) / self.points_per_px
    }

    /// Returns the rectangle that a picture pixel occupies in the window, in points.
    pub(crate) fn rect_of(self, x: u32, y: u32) -> Rect {
        let min = self.corner + vec2(x as f32, y as f32) * self.points_per_px;
        Rect::from_min_size(min, Vec2::splat(self.points_per_px))
    }

    /// Returns the rectangle that the whole picture occupies in the window, in points.
    pub(crate) fn rect_of_all(self, (width, height): (u32, u32)) -> Rect {
        Rect::from_min_size(self.corner, vec2(width as f32, height as f32) * self.points_per_px)
    }

    /// Returns the picture pixel at a position in the window; `None` outside the picture.
    pub(crate) fn pixel_at(self, position: Pos2, (width, height): (u32, u32)) -> Option<(u32, u32)> {
        let p = self.to_picture(position);
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < width as f32 && p.y < height as f32;
        inside.then_some((p.x as u32, p.y as u32))
    }

    /// Returns the visible columns and rows of the picture.
    pub(crate) fn visible(self, (width, height): (u32, u32)) -> (std::ops::Range<u32>, std::ops::Range<u32>) {
        let (min, max) = (self.to_picture(self.canvas.min), self.to_picture(self.canvas.max));
        let range =
            |from: f32, to: f32, size: u32| (from.max(0.0) as u32).min(size)..(to.max(0.0).ceil() as u32).min(size);
        (range(min.x, max.x, width), range(min.y, max.y, height))
    }
}

/// Picture in the window that reacts to the pointer.
#[derive(Clone, Copy)]
pub(crate) struct PlacedPicture<'a> {
    /// Reaction of its rectangle to the pointer.
    pub(crate) response: &'a Response,
    /// Placement of the picture in the rectangle.
    pub(crate) placement: Placement,
    /// Width and height of the picture, in pixels.
    pub(crate) size_px: (u32, u32),
    /// Whether drags with the primary button move picture or camera. Otherwise they have another effect, for example the
    /// selection of a region.
    pub(crate) drag_is_free: bool,
}

impl Zoom {
    /// Fits the whole picture into the rectangle, and keeps it fitted when the rectangle is resized.
    pub(crate) fn fit(&mut self) {
        self.scale = None;
    }

    /// Sets the scale to `scale` screen pixels per picture pixel with `center` (in picture pixels) in the middle.
    pub(crate) fn set_view(&mut self, scale: f32, canvas_px: (u32, u32), center: (f32, f32)) {
        self.scale = Some(scale);
        self.origin = vec2(center.0, center.1) - vec2(canvas_px.0 as f32, canvas_px.1 as f32) / (2.0 * scale);
    }

    /// Centres the view on a pixel and zooms in far enough to distinguish the pixel from its neighbours.
    pub(crate) fn bring_into_view(&mut self, (x, y): (u32, u32), canvas_px: (u32, u32)) {
        let scale = self.scale.unwrap_or(0.0).max(SEEN_FROM);
        self.set_view(scale, canvas_px, (x as f32 + 0.5, y as f32 + 0.5));
    }

    /// Pans no further than necessary to make a pixel and its neighbours visible. A fitted picture does not move.
    pub(crate) fn keep_in_view(&mut self, (x, y): (u32, u32), canvas_px: (u32, u32)) {
        let Some(scale) = self.scale else { return };
        let seen = vec2(canvas_px.0 as f32, canvas_px.1 as f32) / scale;
        let (first, last) = (vec2(x as f32, y as f32) - Vec2::splat(1.0), vec2(x as f32, y as f32) + Vec2::splat(2.0));
        self.origin = self.origin.max(last - seen).min(first);
    }

    /// Returns the scale in screen pixels per picture pixel; `None` if the picture is fitted.
    pub(crate) fn scale(&self) -> Option<f32> {
        self.scale
    }

    /// Returns the placement of a picture on `canvas`.
    pub(crate) fn placement(&self, ui: &Ui, canvas: Rect, (width, height): (u32, u32)) -> Placement {
        let screen = ui.pixels_per_point();
        let size = vec2(width as f32, height as f32);
        let (scale, origin) = match self.scale {
            Some(scale) => (scale, self.origin),
            None => {
                let available = canvas.size() * screen;
                // A canvas without height still needs a non-zero scale: positions are divided by it.
                let exact = (available.x / size.x).min(available.y / size.y).max(MIN_FIT);
                // At 1:1 and above, an integer scale gives all picture pixels the same size.
                let scale = if exact >= 1.0 { exact.floor() } else { exact };
                // The margin is rounded down to whole screen pixels. It is zero if the canvas is less than two screen
                // pixels larger than the picture.
                let beside = ((available - size * scale) / 2.0).floor();
                (scale, -beside / scale)
            }
        };
        let corner = canvas.min - origin * scale / screen;
        let corner = pos2((corner.x * screen).round() / screen, (corner.y * screen).round() / screen);
        Placement { canvas, points_per_px: scale / screen, corner }
    }

    /// Pans the picture by `delta`, in points.
    pub(crate) fn pan(&mut self, ui: &Ui, placement: Placement, delta: Vec2) {
        self.keep(ui, placement);
        self.origin -= delta / placement.points_per_px;
    }

    /// Zooms by `factor` around the pointer, so that the picture does not move under it.
    pub(crate) fn enlarge(&mut self, ui: &Ui, placement: Placement, pointer: Pos2, factor: f32) {
        let under_pointer = placement.to_picture(pointer);
        self.keep(ui, placement);
        let old = self.scale.unwrap_or(1.0);
        self.wheeled = (self.wheeled_of(old) * factor).clamp(SCALE_RANGE.0, SCALE_RANGE.1);
        let scale = if self.wheeled >= WHOLE_FROM { self.wheeled.round() } else { self.wheeled };
        self.scale = Some(scale);
        self.origin = under_pointer - (pointer - placement.canvas.min) * ui.pixels_per_point() / scale;
    }

    /// Turns a fitted view into the same view with an explicit scale and origin.
    fn keep(&mut self, ui: &Ui, placement: Placement) {
        self.scale = Some(placement.points_per_px * ui.pixels_per_point());
        self.origin = placement.to_picture(placement.canvas.min);
    }

    /// Returns the unrounded scale if rounding it yields `shown`, so that small wheel steps accumulate. Otherwise,
    /// returns `shown`.
    fn wheeled_of(&self, shown: f32) -> f32 {
        if (self.wheeled - shown).abs() <= 0.5 && shown >= WHOLE_FROM { self.wheeled } else { shown }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_canvas_without_height_has_finite_positions() {
        let context = eframe::egui::Context::default();
        let canvas = Rect::from_min_size(pos2(10.0, 20.0), vec2(300.0, 0.0));
        let mut placed = None;
        let mut output = context.run_ui(Default::default(), |ui| {
            let mut zoom = Zoom::default();
            let fitted = zoom.placement(ui, canvas, (640, 480));
            zoom.enlarge(ui, fitted, canvas.center(), 1.5);
            placed = Some((fitted, zoom.placement(ui, canvas, (640, 480))));
        });
        output.textures_delta.clear();
        let (fitted, enlarged) = placed.unwrap();
        for placement in [fitted, enlarged] {
            let position = placement.to_picture(canvas.center());
            assert!(position.x.is_finite() && position.y.is_finite(), "{placement:?}");
        }
    }

    #[test]
    fn a_pixel_is_kept_in_view_by_the_smallest_pan() {
        let mut zoom = Zoom::default();
        zoom.keep_in_view((500, 0), (100, 80));
        assert_eq!(zoom.scale(), None, "a fitted picture stays fitted");
        zoom.set_view(10.0, (100, 80), (50.0, 50.0));
        let before = zoom.origin;
        zoom.keep_in_view((50, 50), (100, 80));
        assert_eq!(zoom.origin, before, "the pixel is already visible");
        zoom.keep_in_view((60, 50), (100, 80));
        assert_eq!(zoom.origin, vec2(62.0 - 10.0, before.y), "ten columns are visible, the last beside the pixel");
        zoom.keep_in_view((20, 10), (100, 80));
        assert_eq!(zoom.origin, vec2(19.0, 9.0));
    }
}
