//! The pictures of a case: one picture, or two pictures side by side that pan and zoom together.
//!
//! A picture may exceed the maximum texture size. Therefore, only its visible part becomes a texture, with at most as
//! many texels as screen pixels. The texture is rebuilt when the view changes.

use eframe::egui::{
    Align2, Color32, ColorImage, FontId, Pos2, Rect, Sense, Stroke, TextureHandle, TextureOptions, Ui, Vec2, pos2, vec2,
};

use crate::report::comparison::{Agreement, PixelComparison};
use crate::ui::theme::{font_size, space, tokens};

/// Minimum side length of an enlarged pixel for which grid lines are drawn, in points.
const GRID_FROM: f32 = 7.0;

/// Maximum side length of an enlarged pixel, in points.
const LARGEST_PIXEL: f32 = 64.0;

/// Colour of a pixel covered by neither the tested rasterizer nor the exact result.
const OUTSIDE: Color32 = Color32::from_rgb(0x22, 0x25, 0x2B);

/// Colour of a pixel covered by both the tested rasterizer and the exact result.
const COVERED: Color32 = Color32::from_rgb(0xB9, 0xC3, 0xD2);

/// Colour of a pixel covered by the tested rasterizer only. Orange differs from blue for all common colour vision
/// deficiencies.
const EXTRA: Color32 = Color32::from_rgb(0xF5, 0x8A, 0x1F);

/// Colour of a pixel covered by the exact result only.
const MISSING: Color32 = Color32::from_rgb(0x2F, 0x7D, 0xF6);

/// Pan and zoom of the pictures of a case, and the textures of the visible part.
#[derive(Default)]
pub(super) struct Pictures {
    /// Scale in points per pixel, and the picture position at the centre of the view, in pixels; `None` fits the
    /// picture into the view.
    view: Option<(f32, Vec2)>,
    tiles: [Option<(Visible, TextureHandle)>; 2],
}

/// Visible part of a picture, and the resolution of the texture that shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Visible {
    /// First visible column and row.
    first: [u32; 2],
    /// One past the last visible column and row.
    end: [u32; 2],
    /// Number of texels along x and y, at most one per pixel.
    texels: [usize; 2],
}

/// View of a picture in a rectangle of the window.
#[derive(Clone, Copy)]
struct PictureView {
    /// Rectangle that shows the picture, in points.
    rect: Rect,
    /// Scale in points per pixel.
    scale: f32,
    /// Picture position at the centre of the rectangle, in pixels.
    center: Vec2,
}

impl PictureView {
    /// Converts a position in the window from points to picture pixels.
    fn to_picture(self, point: Pos2) -> Vec2 {
        (point - self.rect.center()) / self.scale + self.center
    }

    /// Converts a position in the picture from pixels to points in the window.
    fn to_window(self, pixel: Vec2) -> Pos2 {
        self.rect.center() + (pixel - self.center) * self.scale
    }
}

impl Visible {
    /// Returns the visible part of a picture. `size` is the size of the picture in pixels.
    fn new(size: (u32, u32), view: PictureView, pixels_per_point: f32) -> Self {
        let rect = view.rect;
        let (least, greatest) = (view.to_picture(rect.min), view.to_picture(rect.max));
        let along = |least: f32, greatest: f32, size: u32, points: f32| {
            let first = (least.floor().max(0.0) as u32).min(size - 1);
            let end = (greatest.ceil().max(0.0) as u32).clamp(first + 1, size);
            let on_screen = (points * pixels_per_point).ceil().max(1.0) as usize;
            (first, end, on_screen.min((end - first) as usize))
        };
        let (left, right, columns) = along(least.x, greatest.x, size.0, rect.width());
        let (top, bottom, rows) = along(least.y, greatest.y, size.1, rect.height());
        Self { first: [left, top], end: [right, bottom], texels: [columns, rows] }
    }

    /// Builds the texture image. Each texel has the colour of the pixel at its centre.
    fn image(self, color: impl Fn(u32, u32) -> Color32) -> ColorImage {
        let [columns, rows] = [0, 1].map(|axis| {
            let (first, texels) = (self.first[axis], self.texels[axis] as u64);
            let pixels = u64::from(self.end[axis] - first);
            (0..texels).map(|texel| first + ((2 * texel + 1) * pixels / (2 * texels)) as u32).collect::<Vec<_>>()
        });
        let texels = rows.iter().flat_map(|y| columns.iter().map(|x| color(*x, *y)));
        ColorImage::new(self.texels, texels.collect())
    }

    fn corners(self) -> [Vec2; 2] {
        [self.first, self.end].map(|[x, y]| vec2(x as f32, y as f32))
    }
}

impl Pictures {
    /// Drops the textures, so that they are rebuilt. Must be called after the picture has changed.
    pub(super) fn invalidate(&mut self) {
        self.tiles = [None, None];
    }

    /// Centres the view on a pixel and zooms in far enough to show it.
    pub(super) fn visit(&mut self, (x, y): (u32, u32)) {
        let scale = self.view.map_or(24.0, |(scale, _)| scale.max(16.0));
        self.view = Some((scale, vec2(x as f32 + 0.5, y as f32 + 0.5)));
    }

    /// Draws the pixels covered by the tested rasterizer and, beside them, the exact result if there is one.
    pub(super) fn ui(&mut self, ui: &mut Ui, comparison: &PixelComparison) {
        let (area, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        let count = if comparison.exact.is_some() { 2.0 } else { 1.0 };
        let (width, height) = comparison.ours.size();
        let size = vec2(width as f32, height as f32);
        let tile = vec2((area.width() - space::S * (count + 1.0)) / count, area.height() - space::L - 2.0 * space::S);
        let fitted = (tile / size).min_elem().min(LARGEST_PIXEL);
        let (mut scale, mut center) = self.view.unwrap_or((fitted, size / 2.0));
        if response.dragged() {
            center -= response.drag_delta() / scale;
        }
        let wheel = if response.hovered() { ui.input(|i| i.smooth_scroll_delta().y) } else { 0.0 };
        if wheel != 0.0 {
            scale = (scale * (wheel * 0.005).exp()).clamp(fitted * 0.5, LARGEST_PIXEL);
        }
        if response.dragged() || wheel != 0.0 {
            self.view = Some((scale, center));
        }
        if response.double_clicked() {
            self.view = None;
        }
        let ours = |x: u32, y: u32| match comparison.agreement(x, y) {
            Agreement::Outside | Agreement::Missing => OUTSIDE,
            Agreement::Covered => OUTSIDE.lerp_to_gamma(COVERED, comparison.ours.at(x, y)),
            Agreement::Extra => EXTRA,
        };
        let exact = |x: u32, y: u32| match comparison.agreement(x, y) {
            Agreement::Outside | Agreement::Extra => OUTSIDE,
            Agreement::Covered => COVERED,
            Agreement::Missing => MISSING,
        };
        let colors: [(_, &dyn Fn(u32, u32) -> Color32); 2] = [("Drawn", &ours), ("Exact result", &exact)];
        let mut hovered = None;
        for (index, (title, color)) in colors.into_iter().take(count as usize).enumerate() {
            let left = area.left() + space::S + index as f32 * (tile.x + space::S);
            let rect = Rect::from_min_size(pos2(left, area.top() + space::L + space::S), tile);
            let small = FontId::proportional(font_size::SMALL);
            let anchor = rect.left_top() - vec2(0.0, 4.0);
            ui.painter().text(anchor, Align2::LEFT_BOTTOM, title, small, tokens(ui).text_weak);
            let view = PictureView { rect, scale, center };
            let visible = Visible::new((width, height), view, ui.pixels_per_point());
            let known = self.tiles[index].take().filter(|(drawn, _)| *drawn == visible);
            let texture = known.map_or_else(
                || ui.ctx().load_texture(title, visible.image(color), TextureOptions::NEAREST),
                |(_, texture)| texture,
            );
            picture(ui, view, visible, &texture, comparison);
            self.tiles[index] = Some((visible, texture));
            if let Some(pointer) = response.hover_pos().filter(|pointer| rect.contains(*pointer)) {
                let place = view.to_picture(pointer);
                hovered = Some((place.x.floor() as i64, place.y.floor() as i64));
            }
        }
        if let Some((x, y)) = hovered.filter(|(x, y)| (0..width.into()).contains(x) && (0..height.into()).contains(y)) {
            let word = match comparison.agreement(x as u32, y as u32) {
                Agreement::Outside => "not covered",
                Agreement::Covered => "covered",
                Agreement::Extra => "drawn, but not covered by the exact result",
                Agreement::Missing => "not drawn, but covered by the exact result",
            };
            let (column, row) = (x + comparison.origin.0, y + comparison.origin.1);
            response.on_hover_text_at_pointer(format!("Pixel {column}, {row}: {word}"));
        }
    }
}

/// Draws the visible part of a picture, a grid between large pixels, and the outlines of the case.
fn picture(ui: &Ui, view: PictureView, visible: Visible, texture: &TextureHandle, comparison: &PixelComparison) {
    let painter = ui.painter().with_clip_rect(view.rect);
    let place = |pixel| view.to_window(pixel);
    let [first, end] = visible.corners();
    let part = Rect::from_min_max(place(first), place(end));
    painter.image(texture.id(), part, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), Color32::WHITE);
    if view.scale >= GRID_FROM {
        let stroke = Stroke::new(1.0, Color32::from_white_alpha(18));
        for x in visible.first[0]..=visible.end[0] {
            painter.vline(place(vec2(x as f32, 0.0)).x, part.y_range(), stroke);
        }
        for y in visible.first[1]..=visible.end[1] {
            painter.hline(part.x_range(), place(vec2(0.0, y as f32)).y, stroke);
        }
    }
    let stroke = Stroke::new(1.5, tokens(ui).accent);
    for outline in &comparison.outlines {
        // Corners may lie up to 10³⁸ px away. They are clamped to a range that the painter's floats can handle.
        let near = |c: f64| c.clamp(-1e5, 1e5) as f32;
        let corner = |index: usize| {
            let [x, y] = outline[index % outline.len()];
            place(vec2(near(x), near(y)))
        };
        // Separate segments, not one polyline: the miter join at the tip of a needle would be as long as the needle
        // itself.
        for side in 0..outline.len() {
            painter.line_segment([corner(side), corner(side + 1)], stroke);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TILE: Rect = Rect { min: Pos2::ZERO, max: Pos2::new(500.0, 300.0) };

    /// Returns the visible part of a picture of `size` pixels at `scale` points per pixel, with the picture position
    /// `center` in the middle.
    fn visible(size: (u32, u32), scale: f32, center: Vec2) -> Visible {
        Visible::new(size, PictureView { rect: TILE, scale, center }, 1.0)
    }

    #[test]
    fn no_texture_is_larger_than_the_screen() {
        for (size, scale) in [((16_384, 2_048), 500.0 / 16_384.0), ((2_048, 16_384), 1.0), ((8, 8), 64.0)] {
            let visible = visible(size, scale, vec2(size.0 as f32, size.1 as f32) / 2.0);
            assert!(visible.texels[0] <= 500 && visible.texels[1] <= 300, "{visible:?}");
            let image = visible.image(|x, y| {
                assert!(x < size.0 && y < size.1);
                Color32::WHITE
            });
            assert_eq!(image.size, visible.texels);
        }
    }

    #[test]
    fn every_visible_pixel_has_its_own_texel_where_there_is_room() {
        let visible = visible((90, 40), 20.0, vec2(85.0, 2.0));
        assert_eq!((visible.first, visible.end), ([72, 0], [90, 10]));
        assert_eq!(visible.texels, [18, 10]);
        let image = visible.image(|x, y| Color32::from_rgb(x as u8, y as u8, 0));
        assert_eq!(image[(0, 0)], Color32::from_rgb(72, 0, 0));
        assert_eq!(image[(17, 9)], Color32::from_rgb(89, 9, 0));
    }

    #[test]
    fn a_picture_outside_the_view_still_has_a_texture() {
        let visible = visible((90, 40), 20.0, vec2(-4_000.0, 9_000.0));
        assert_eq!((visible.first, visible.end), ([0, 39], [1, 40]));
    }
}
