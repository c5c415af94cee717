//! Compared pictures on the canvas: shown as tiles with shared zoom, position and pick, as a wipe, as a flip, or as a
//! difference image.

pub(super) mod figures;

mod files;

mod header;

mod layout;

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Color32, CursorIcon, FontId, Painter, Rect, Role, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo,
    pos2,
};

use figures::{figures_of, figures_of_both};
use header::headers;
use layout::{TileLayout, places};

use crate::image::{Image, Rgba8};
use crate::inspect::view::Value;
use crate::inspect::what_if::Changes;
use crate::measure::region::PixelRegion;
use crate::ui::changed_layer::{self, ChangedLayer};
use crate::ui::panels::canvas::{grid, marker, numbers};
use crate::ui::panels::navigate::navigate;
use crate::ui::picture_texture::PictureTexture;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::compare::compute::{Compared, DifferenceImage, TileResult};
use crate::ui::session::compare::{CompareChange, Mode};
use crate::ui::session::picture_role::letter;
use crate::ui::theme::{MARK_EDGE, RADIUS, font_size, space, tokens};
use crate::ui::zoom::{PlacedPicture, Placement, Zoom};

/// Distance from the wipe line within which the pointer grabs it, in points.
const HOLD: f32 = 7.0;

/// Drag operation other than panning.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TileDrag {
    /// Draws a region between the pixel where the drag started and the pixel under the pointer.
    Region((u32, u32), (u32, u32)),
    /// Moves the wipe line.
    Wipe,
}

/// Tile on the canvas.
#[derive(Clone, Copy)]
struct PlacedTile<'a> {
    index: usize,
    layout: TileLayout,
    picture: PlacedPicture<'a>,
}

/// Textures and drag state of the compared pictures.
#[derive(Default)]
pub(crate) struct TilesView {
    textures: Vec<PictureTexture>,
    difference: PictureTexture,
    changed: ChangedLayer,
    dragging: Option<TileDrag>,
}

impl TilesView {
    /// Returns the size of a tile's picture, in points. `canvas` is the area for all tiles.
    pub(crate) fn picture_size(canvas: Rect, session: &Session) -> Vec2 {
        places(canvas, session).first().map_or(canvas.size(), |place| place.picture.size())
    }

    /// Returns the rectangle around all pictures on the canvas, in points, without the headers above and the errors
    /// below them.
    pub(crate) fn pictures(canvas: Rect, session: &Session) -> Rect {
        places(canvas, session).iter().map(|place| place.picture).reduce(Rect::union).unwrap_or(canvas)
    }

    /// Draws all compared pictures and turns input into commands. Returns the pixel under the pointer.
    pub(crate) fn ui(
        &mut self,
        ui: &mut Ui,
        zoom: &mut Zoom,
        session: &Session,
        commands: &mut Vec<Command>,
    ) -> Option<(u32, u32)> {
        let canvas = ui.max_rect();
        ui.painter().rect_filled(canvas, 0.0, tokens(ui).canvas);
        let compared = session.features.comparison.compared.as_ref().filter(|compared| !compared.tiles.is_empty());
        let places = places(canvas, session);
        let size = compared.map_or((1, 1), |compared| compared.tiles[0].picture.size());
        let hovered_before = ui.data(|data| data.get_temp::<Option<(u32, u32)>>(hover_id())).flatten();
        let mut hovered = None;
        let mut responses = Vec::new();
        for (index, place) in places.iter().enumerate() {
            headers(ui, index, *place, session, commands);
            let response = ui.allocate_rect(place.picture, Sense::click_and_drag());
            let placement = zoom.placement(ui, place.picture, size);
            if compared.is_some() {
                let picture = PlacedPicture { response: &response, placement, size_px: size, drag_is_free: true };
                let drag_is_free = self.drag(ui, picture, session, commands);
                navigate(ui, PlacedPicture { drag_is_free, ..picture }, zoom, session, commands);
                hovered = hovered.or(response.hover_pos().and_then(|at| placement.pixel_at(at, size)));
                pick(picture, index, session, commands);
            }
            responses.push(response);
        }
        for (index, (place, response)) in places.iter().zip(&responses).enumerate() {
            let placement = zoom.placement(ui, place.picture, size);
            let picture = PlacedPicture { response, placement, size_px: size, drag_is_free: true };
            let tile = PlacedTile { index, layout: *place, picture };
            match compared {
                Some(compared) => {
                    self.picture(ui, tile, compared, session);
                    self.marks(ui, picture, hovered_before.filter(|_| !response.hovered()), session);
                }
                None => waiting(ui, place.picture),
            }
            if let Some((compared, pixel)) = compared.zip(hovered_before.or(session.pick)) {
                files::readout(ui, tile, pixel, session, compared);
            }
            frame(ui, index, *place, session);
        }
        files::dropped(ui, &responses, session, commands);
        ui.data_mut(|data| data.insert_temp(hover_id(), hovered));
        hovered
    }

    /// Handles dragging of regions and of the wipe line. Returns whether drags with the primary button move picture or
    /// camera.
    fn drag(&mut self, ui: &Ui, picture: PlacedPicture<'_>, session: &Session, commands: &mut Vec<Command>) -> bool {
        let PlacedPicture { response, placement, size_px: size, .. } = picture;
        let comparison = &session.features.comparison;
        let rect = response.rect;
        let nearest = |at: egui::Pos2| {
            let p = placement.to_picture(at);
            let clamped = |v: f32, size: u32| (v.max(0.0) as u32).min(size.saturating_sub(1));
            (clamped(p.x, size.0), clamped(p.y, size.1))
        };
        let near_line = |at: egui::Pos2| {
            comparison.mode == Mode::Wipe && (at.x - line_x(rect, comparison.wipe)).abs() <= HOLD && rect.contains(at)
        };
        if response.hover_pos().is_some_and(near_line) || self.dragging == Some(TileDrag::Wipe) {
            ui.set_cursor_icon(CursorIcon::ResizeHorizontal);
        }
        if response.drag_started_by(egui::PointerButton::Primary)
            && let Some(at) = ui.input(|i| i.pointer.press_origin())
        {
            self.dragging = match () {
                () if near_line(at) => Some(TileDrag::Wipe),
                () if comparison.draws_region => Some(TileDrag::Region(nearest(at), nearest(at))),
                () => None,
            };
        }
        let at = response.interact_pointer_pos().filter(|_| response.dragged() || response.drag_stopped());
        if let Some(at) = at {
            match &mut self.dragging {
                Some(TileDrag::Wipe) => {
                    commands.push(Command::Compare(CompareChange::Wipe((at.x - rect.left()) / rect.width().max(1.0))));
                }
                Some(TileDrag::Region(_, to)) => *to = nearest(at),
                None => {}
            }
        }
        let drag_is_free = self.dragging.is_none();
        if response.drag_stopped()
            && let Some(dragging) = self.dragging.take()
            && let TileDrag::Region(from, to) = dragging
        {
            commands.push(Command::Compare(CompareChange::Region(Some(between(from, to)))));
            commands.push(Command::Compare(CompareChange::DrawRegion(false)));
        }
        drag_is_free
    }

    /// Draws the picked pixel, the region, and a cross at the pixel hovered in another tile.
    fn marks(&self, ui: &Ui, picture: PlacedPicture<'_>, cross: Option<(u32, u32)>, session: &Session) {
        let PlacedPicture { response, placement, size_px: (width, height), .. } = picture;
        let painter = &ui.painter().with_clip_rect(response.rect);
        if let Some(pixel) = session.pick.filter(|(x, y)| *x < width && *y < height) {
            marker(painter, placement, pixel, tokens(ui).accent);
        }
        if let Some((x, y)) = cross {
            let pixel = placement.rect_of(x, y);
            let arm = 8.0 + pixel.width() / 2.0;
            for color in [Stroke::new(3.0, MARK_EDGE), Stroke::new(1.0, tokens(ui).text_strong)] {
                let center = pixel.center();
                painter.hline(center.x - arm..=center.x - pixel.width() / 2.0 - 2.0, center.y, color);
                painter.hline(center.x + pixel.width() / 2.0 + 2.0..=center.x + arm, center.y, color);
                painter.vline(center.x, center.y - arm..=center.y - pixel.width() / 2.0 - 2.0, color);
                painter.vline(center.x, center.y + pixel.width() / 2.0 + 2.0..=center.y + arm, color);
            }
        }
        let drawn = match self.dragging {
            Some(TileDrag::Region(from, to)) => Some(between(from, to)),
            _ => session.features.comparison.region,
        };
        if let Some(PixelRegion { left, top, right, bottom }) = drawn {
            let (first, last) = (placement.rect_of(left, top), placement.rect_of(right, bottom));
            let rect = Rect::from_min_max(first.min, last.min);
            painter.rect_stroke(rect, 0.0, Stroke::new(3.0, MARK_EDGE), StrokeKind::Outside);
            painter.rect_stroke(rect, 0.0, Stroke::new(1.0, tokens(ui).accent), StrokeKind::Outside);
        }
    }

    /// Draws the pictures and figures that a tile shows in the current mode.
    fn picture(&mut self, ui: &Ui, tile: PlacedTile<'_>, compared: &Compared, session: &Session) {
        let PlacedTile { index, layout, picture: PlacedPicture { response, placement, .. } } = tile;
        let (shift, ctrl) = ui.input(|i| (i.modifiers.shift, i.modifiers.ctrl || i.modifiers.command));
        let mode = session.features.comparison.mode;
        let name = match mode {
            Mode::Tiles => format!("Picture {}", letter(index)),
            Mode::Off | Mode::Wipe | Mode::Flip | Mode::Difference => "Compared pictures".to_owned(),
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &name));
        let whole = layout.picture;
        match mode {
            Mode::Off | Mode::Tiles => {
                let shown = if shift { 0 } else { index };
                self.tile(ui, shown, placement, compared);
                if shift && index > 0 {
                    badge(ui, whole, 0, "A, while Shift is held");
                }
                figures_of(ui, index, layout.footer, compared, session);
            }
            Mode::Flip => {
                let shown = usize::from(shift);
                self.tile(ui, shown, placement, compared);
                badge(ui, whole, shown, if shift { "B" } else { "A (hold Shift to show B)" });
                figures_of_both(ui, layout.footer, compared, session);
            }
            Mode::Wipe => {
                let x = if shift { whole.left() } else { line_x(whole, session.features.comparison.wipe) };
                self.tile(ui, 0, Placement { canvas: whole.with_max_x(x), ..placement }, compared);
                self.tile(ui, 1, Placement { canvas: whole.with_min_x(x), ..placement }, compared);
                if !shift {
                    let painter = ui.painter().with_clip_rect(whole);
                    painter.vline(x, whole.y_range(), Stroke::new(3.0, MARK_EDGE));
                    painter.vline(x, whole.y_range(), Stroke::new(1.0, tokens(ui).text_strong));
                    painter.circle(pos2(x, whole.center().y), 5.0, tokens(ui).text_strong, Stroke::new(2.0, MARK_EDGE));
                }
                figures_of_both(ui, layout.footer, compared, session);
            }
            Mode::Difference => {
                if shift || ctrl {
                    self.tile(ui, usize::from(shift), placement, compared);
                    badge(ui, whole, usize::from(shift), if shift { "B" } else { "A" });
                } else if let Some((changes, b)) = changed_pixels(compared) {
                    self.changed(ui, placement, changes, b);
                } else if let Some(differing) = &compared.difference {
                    self.difference(ui, placement, differing);
                } else {
                    let why = "No difference to show: A and B have different sizes or are still being drawn";
                    ui.painter().text(whole.center(), Align2::CENTER_CENTER, why, small(), tokens(ui).text_weak);
                }
                figures_of_both(ui, layout.footer, compared, session);
            }
        }
    }

    /// Draws the picture of one tile, clipped to the canvas of the placement.
    fn tile(&mut self, ui: &Ui, tile: usize, placement: Placement, compared: &Compared) {
        let Some(TileResult { picture, .. }) = compared.tiles.get(tile) else { return waiting(ui, placement.canvas) };
        while self.textures.len() <= tile {
            self.textures.push(PictureTexture::default());
        }
        let texture = self.textures[tile].show(ui, picture);
        let painter = ui.painter().with_clip_rect(placement.canvas);
        paint(&painter, texture, placement, picture.size());
        numbers(&painter, placement, picture, ui.input(|i| i.modifiers.alt), |x, y| Value::Color(picture.at(x, y)));
    }

    /// Marks changed pixels over the dimmed picture B.
    fn changed(&mut self, ui: &Ui, placement: Placement, changes: &Arc<Changes>, b: &TileResult) {
        let texture = self.difference.show(ui, &b.picture);
        let painter = ui.painter().with_clip_rect(placement.canvas);
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        painter.image(texture, placement.rect_of_all(b.picture.size()), uv, changed_layer::DIMMED);
        self.changed.paint(ui, &painter, placement, changes);
        grid(&painter, placement, b.picture.size());
    }

    fn difference(&mut self, ui: &Ui, placement: Placement, differing: &DifferenceImage) {
        let picture: &Image<Rgba8> = &differing.picture;
        let texture = self.difference.show(ui, &differing.picture);
        let painter = ui.painter().with_clip_rect(placement.canvas);
        paint(&painter, texture, placement, picture.size());
        let bits = ui.input(|i| i.modifiers.alt);
        numbers(&painter, placement, picture, bits, |x, y| Value::Number(differing.values.at(x, y)));
    }
}

/// Returns the changed pixels and tile B if the difference image shows changed pixels.
fn changed_pixels(compared: &Compared) -> Option<(&Arc<Changes>, &TileResult)> {
    compared.difference.as_ref()?.changes.as_ref().zip(compared.tiles.get(1))
}

fn hover_id() -> egui::Id {
    egui::Id::unique("compared pixel under the pointer")
}

fn small() -> FontId {
    FontId::proportional(font_size::SMALL)
}

fn line_x(rect: Rect, share: f32) -> f32 {
    rect.left() + rect.width() * share
}

/// Returns the smallest region that contains both pixels.
fn between(a: (u32, u32), b: (u32, u32)) -> PixelRegion {
    PixelRegion { left: a.0.min(b.0), top: a.1.min(b.1), right: a.0.max(b.0) + 1, bottom: a.1.max(b.1) + 1 }
}

fn paint(painter: &Painter, texture: egui::TextureId, placement: Placement, size: (u32, u32)) {
    let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    painter.image(texture, placement.rect_of_all(size), uv, Color32::WHITE);
    grid(painter, placement, size);
}

fn waiting(ui: &Ui, rect: Rect) {
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, "Drawing …", small(), tokens(ui).text_weak);
}

/// Selects the tile of this index, and picks the pixel under the pointer if it is clicked.
fn pick(picture: PlacedPicture<'_>, index: usize, session: &Session, commands: &mut Vec<Command>) {
    let PlacedPicture { response, placement, size_px: size, .. } = picture;
    let questioned = response.clicked_by(egui::PointerButton::Primary)
        || response.clicked_by(egui::PointerButton::Secondary)
        || response.dragged_by(egui::PointerButton::Secondary);
    let Some(at) = response.interact_pointer_pos().filter(|_| questioned) else { return };
    let comparison = &session.features.comparison;
    let tile = match comparison.mode {
        Mode::Tiles => index,
        Mode::Wipe => usize::from(at.x >= line_x(response.rect, comparison.wipe)),
        Mode::Off | Mode::Flip | Mode::Difference => session.state.tiles.active,
    };
    if tile != session.state.tiles.active {
        commands.push(Command::Compare(CompareChange::Activate(tile)));
    }
    if let Some(pixel) = placement.pixel_at(at, size) {
        commands.push(Command::Pick(Some(pixel)));
    }
}

/// Returns the colour of a tile's letter.
fn color(ui: &Ui, tile: usize) -> Color32 {
    match tile {
        0 => tokens(ui).a,
        1 => tokens(ui).b,
        _ => tokens(ui).text_weak,
    }
}

/// Draws a line in the tile's colour along its top edge, and an outline around the picture of the active tile.
fn frame(ui: &Ui, index: usize, place: TileLayout, session: &Session) {
    if session.features.comparison.mode != Mode::Tiles {
        return;
    }
    let top = place.picture.with_max_y(place.picture.top() + 2.0);
    ui.painter().rect_filled(top, 0.0, color(ui, index));
    if index == session.state.tiles.active {
        ui.painter().rect_stroke(place.picture, 0.0, Stroke::new(1.5, tokens(ui).accent), StrokeKind::Inside);
    }
}

/// Draws a label in the upper left corner of the picture, in the colour of the tile that is visible there.
fn badge(ui: &Ui, picture: Rect, tile: usize, words: &str) {
    let painter = ui.painter().with_clip_rect(picture);
    let text = painter.layout_no_wrap(words.to_owned(), FontId::proportional(font_size::TITLE), color(ui, tile));
    let at = picture.min + Vec2::splat(space::S);
    painter.rect_filled(
        Rect::from_min_size(at, text.size()).expand(space::XS),
        RADIUS,
        tokens(ui).panel.gamma_multiply(0.92),
    );
    painter.galley(at, text, color(ui, tile));
}
