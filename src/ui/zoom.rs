//! Where a picture lies on a rectangle of the window: fitted, or enlarged at the pointer and moved.
//!
//! A fitted picture, and one enlarged a lot, is shown at a whole factor, so that all squares are equal. Rectangles of the
//! same size that share one [`Zoom`] show the same part of their pictures.

use eframe::egui::{Pos2, Rect, Ui, Vec2, pos2, vec2};

/// Screen pixels per picture pixel, least and greatest.
const SCALE_RANGE: (f32, f32) = (1.0 / 32.0, 256.0);

/// Least scale of a fitted picture: a canvas without height must not divide by zero.
const LEAST_FIT: f32 = 1.0 / 65_536.0;

/// From this enlargement on it is a whole factor.
const WHOLE_FROM: f32 = 8.0;

/// A pixel that is looked for is enlarged at least so much: its neighbours and the course of an edge are seen, too.
const SEEN_FROM: f32 = 16.0;

/// How far a picture is enlarged, and which part of it is seen.
#[derive(Clone, Copy, Debug, Default)]
pub struct Zoom {
    /// Screen pixels per picture pixel; `None` fits the picture into the rectangle.
    scale: Option<f32>,
    /// The enlargement that the wheel has come to, before it is rounded to a whole factor.
    wheeled: f32,
    /// Picture position at the rectangle's top-left corner, in picture pixels.
    origin: Vec2,
}

/// Where a picture is drawn in this frame of the window.
#[derive(Clone, Copy, Debug)]
pub struct Placement {
    /// The rectangle, in points.
    pub canvas: Rect,
    /// Points per picture pixel.
    pub points_per_px: f32,
    /// Top-left corner of the picture, in points.
    pub corner: Pos2,
}

impl Placement {
    /// Where a position on the window lies in the picture, in picture pixels.
    pub fn to_picture(self, position: Pos2) -> Vec2 {
        (position - self.corner) / self.points_per_px
    }

    /// The place of a pixel on the window.
    pub fn rect_of(self, x: u32, y: u32) -> Rect {
        let min = self.corner + vec2(x as f32, y as f32) * self.points_per_px;
        Rect::from_min_size(min, Vec2::splat(self.points_per_px))
    }

    /// The place of the whole picture.
    pub fn rect_of_all(self, (width, height): (u32, u32)) -> Rect {
        Rect::from_min_size(self.corner, vec2(width as f32, height as f32) * self.points_per_px)
    }

    /// The pixel at a position on the window, if there is one.
    pub fn pixel_at(self, position: Pos2, (width, height): (u32, u32)) -> Option<(u32, u32)> {
        let p = self.to_picture(position);
        let inside = p.x >= 0.0 && p.y >= 0.0 && p.x < width as f32 && p.y < height as f32;
        inside.then_some((p.x as u32, p.y as u32))
    }

    /// Picture columns and rows that are on the rectangle.
    pub fn visible(self, (width, height): (u32, u32)) -> (std::ops::Range<u32>, std::ops::Range<u32>) {
        let (min, max) = (self.to_picture(self.canvas.min), self.to_picture(self.canvas.max));
        let range =
            |from: f32, to: f32, size: u32| (from.max(0.0) as u32).min(size)..(to.max(0.0).ceil() as u32).min(size);
        (range(min.x, max.x, width), range(min.y, max.y, height))
    }
}

impl Zoom {
    /// Enlarges so that the whole picture fits, and stays so.
    pub fn fit(&mut self) {
        self.scale = None;
    }

    /// Enlarges to `scale` screen pixels per picture pixel with `center` (picture px) in the middle.
    pub fn set_view(&mut self, scale: f32, canvas_px: (u32, u32), center: (f32, f32)) {
        self.scale = Some(scale);
        self.origin = vec2(center.0, center.1) - vec2(canvas_px.0 as f32, canvas_px.1 as f32) / (2.0 * scale);
    }

    /// Puts a pixel into the middle, enlarged enough to be seen.
    pub fn bring_into_view(&mut self, (x, y): (u32, u32), canvas_px: (u32, u32)) {
        let scale = self.scale.unwrap_or(0.0).max(SEEN_FROM);
        self.set_view(scale, canvas_px, (x as f32 + 0.5, y as f32 + 0.5));
    }

    /// Moves the picture no further than needed to have a pixel and its neighbours on the rectangle; a fitted one is there.
    pub fn keep_in_view(&mut self, (x, y): (u32, u32), canvas_px: (u32, u32)) {
        let Some(scale) = self.scale else { return };
        let seen = vec2(canvas_px.0 as f32, canvas_px.1 as f32) / scale;
        let (first, last) = (vec2(x as f32, y as f32) - Vec2::splat(1.0), vec2(x as f32, y as f32) + Vec2::splat(2.0));
        self.origin = self.origin.max(last - seen).min(first);
    }

    /// Screen pixels per picture pixel, if not fitted.
    pub fn scale(&self) -> Option<f32> {
        self.scale
    }

    /// Where a picture lies on `canvas`.
    pub fn placement(&self, ui: &Ui, canvas: Rect, (width, height): (u32, u32)) -> Placement {
        let screen = ui.pixels_per_point();
        let size = vec2(width as f32, height as f32);
        let (scale, origin) = match self.scale {
            Some(scale) => (scale, self.origin),
            None => {
                let available = canvas.size() * screen;
                // A canvas of no height still has a scale: positions on it are divided by it.
                let exact = (available.x / size.x).min(available.y / size.y).max(LEAST_FIT);
                // From 1:1 on only whole factors, so that all squares are equal.
                let scale = if exact >= 1.0 { exact.floor() } else { exact };
                // Whole pixels of the screen: a canvas that is larger by less than one shows the picture in its corner.
                let beside = ((available - size * scale) / 2.0).floor();
                (scale, -beside / scale)
            }
        };
        let corner = canvas.min - origin * scale / screen;
        let corner = pos2((corner.x * screen).round() / screen, (corner.y * screen).round() / screen);
        Placement { canvas, points_per_px: scale / screen, corner }
    }

    /// Moves the picture by `delta` points.
    pub fn pan(&mut self, ui: &Ui, placement: Placement, delta: Vec2) {
        self.keep(ui, placement);
        self.origin -= delta / placement.points_per_px;
    }

    /// Enlarges by `factor`; what is under the pointer stays there.
    pub fn enlarge(&mut self, ui: &Ui, placement: Placement, pointer: Pos2, factor: f32) {
        let under_pointer = placement.to_picture(pointer);
        self.keep(ui, placement);
        let old = self.scale.unwrap_or(1.0);
        self.wheeled = (self.wheeled_of(old) * factor).clamp(SCALE_RANGE.0, SCALE_RANGE.1);
        let scale = if self.wheeled >= WHOLE_FROM { self.wheeled.round() } else { self.wheeled };
        self.scale = Some(scale);
        self.origin = under_pointer - (pointer - placement.canvas.min) * ui.pixels_per_point() / scale;
    }

    /// Turns a fitted view into the same one with numbers of its own.
    fn keep(&mut self, ui: &Ui, placement: Placement) {
        self.scale = Some(placement.points_per_px * ui.pixels_per_point());
        self.origin = placement.to_picture(placement.canvas.min);
    }

    /// The unrounded enlargement behind a shown one: wheel steps smaller than one must add up.
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
    fn a_pixel_is_kept_in_view_by_the_least_move() {
        let mut zoom = Zoom::default();
        zoom.keep_in_view((500, 0), (100, 80));
        assert_eq!(zoom.scale(), None, "what is fitted stays so");
        zoom.set_view(10.0, (100, 80), (50.0, 50.0));
        let before = zoom.origin;
        zoom.keep_in_view((50, 50), (100, 80));
        assert_eq!(zoom.origin, before, "it is seen already");
        zoom.keep_in_view((60, 50), (100, 80));
        assert_eq!(zoom.origin, vec2(62.0 - 10.0, before.y), "ten columns are seen, the one beyond it is the last");
        zoom.keep_in_view((20, 10), (100, 80));
        assert_eq!(zoom.origin, vec2(19.0, 9.0));
    }
}
