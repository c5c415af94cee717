//! Widgets of the filmstrip.

mod frames;

use std::sync::Arc;

use eframe::egui::{
    self, Align2, Color32, FontId, Rect, Role, ScrollArea, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2,
};

use crate::image::{Image, Rgba8};
use crate::measure::region::PixelRegion;
use crate::ui::method_colors::method_color;
use crate::ui::panels::tradeoff;
use crate::ui::picture_texture::PictureTexture;
use crate::ui::session::Session;
use crate::ui::session::command::Command;
use crate::ui::session::filmstrip::{FilmstripChange, detail, scales};
use crate::ui::session::picture_role::PictureRole;
use crate::ui::session::timings::RowOrder;
use crate::ui::theme::{font_size, space, tokens};
use crate::ui::widgets::combo;
use crate::upscale::Upscaling;
use frames::StripFrame;

/// Size of the picture of a frame, in points.
const PICTURE: Vec2 = vec2(128.0, 46.0);

/// Height of a line of text below a picture, in points.
const LINE: f32 = 13.0;

/// Width of the column with the settings, in points.
const SETTINGS_WIDTH: f32 = 108.0;

/// Margin above and below the strip, in points.
pub(crate) const MARGIN: i8 = 3;

/// Space for the scroll bar, in points.
const SCROLL_BAR: f32 = 10.0;

/// Height of the strip, in points: pictures, two lines of text, scroll bar, and margins.
pub(crate) const HEIGHT: f32 = PICTURE.y + 2.0 * LINE + SCROLL_BAR + 2.0 * MARGIN as f32;

/// Texture of one frame, with the picture and the part of it that the texture shows.
#[derive(Default)]
struct FrameTexture {
    texture: PictureTexture,
    shown: Option<(Arc<Image<Rgba8>>, PixelRegion)>,
    part: Option<Arc<Image<Rgba8>>>,
}

impl FrameTexture {
    /// Returns a part of a picture, which is cut out again only if picture or region have changed.
    fn part(&mut self, picture: &Arc<Image<Rgba8>>, region: PixelRegion) -> Arc<Image<Rgba8>> {
        let is_same = |(old, at): &(Arc<Image<Rgba8>>, PixelRegion)| Arc::ptr_eq(old, picture) && *at == region;
        if let Some(part) = self.part.as_ref().filter(|_| self.shown.as_ref().is_some_and(is_same)) {
            return part.clone();
        }
        self.shown = Some((picture.clone(), region));
        let (width, height) = (region.right - region.left, region.bottom - region.top);
        let part = Image::from_fn(width, height, |x, y| picture.at(region.left + x, region.top + y));
        self.part.insert(Arc::new(part)).clone()
    }
}

/// Textures of the frames.
#[derive(Default)]
pub(crate) struct FilmstripView {
    textures: Vec<(Upscaling, FrameTexture)>,
}

impl FilmstripView {
    /// Draws the settings and all frames in one row, which scrolls sideways if it is too long.
    pub(crate) fn ui(&mut self, ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
        let frames = frames::collect(session);
        self.textures.retain(|(upscaling, _)| frames.iter().any(|frame| frame.upscaling == *upscaling));
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = space::S;
            ui.allocate_ui(vec2(SETTINGS_WIDTH, HEIGHT), |ui| ui.vertical(|ui| settings(ui, session, commands)));
            ScrollArea::horizontal().auto_shrink(false).show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    for frame in &frames {
                        self.frame(ui, frame, session, commands);
                    }
                });
            });
        });
    }

    fn frame(&mut self, ui: &mut Ui, frame: &StripFrame, session: &Session, commands: &mut Vec<Command>) {
        let label = frame.upscaling.label();
        let (rect, response) = ui.allocate_exact_size(PICTURE + vec2(0.0, 2.0 * LINE), Sense::click());
        response.widget_info(|| {
            WidgetInfo::labeled(Role::Button, true, format!("Compare with {label}: {}", frame.figures()))
        });
        if !ui.is_rect_visible(rect) {
            return;
        }
        let (picture, text) = rect.split_top_bottom_at_y(rect.top() + PICTURE.y);
        self.picture(ui, picture, frame, session.pick);
        let outline = match letter_of(frame.upscaling, session) {
            Some(0) => Stroke::new(2.0, tokens(ui).a),
            Some(_) => Stroke::new(2.0, tokens(ui).b),
            None if response.hovered() || response.has_focus() => Stroke::new(1.0, tokens(ui).accent),
            None => Stroke::new(1.0, tokens(ui).border),
        };
        ui.painter().rect_stroke(picture, 0.0, outline, StrokeKind::Inside);
        let painter = ui.painter().with_clip_rect(rect);
        let small = FontId::proportional(font_size::SMALL);
        painter.circle_filled(
            pos2(text.left() + 3.0, text.top() + LINE / 2.0 + 1.0),
            3.0,
            method_color(ui, frame.upscaling),
        );
        painter.text(text.min + vec2(10.0, 1.0), Align2::LEFT_TOP, &label, small.clone(), tokens(ui).text);
        painter.text(text.min + vec2(0.0, LINE + 1.0), Align2::LEFT_TOP, frame.figures(), small, tokens(ui).text_weak);
        let help = format!("{label}: click to show it as picture B, Shift + click as picture A");
        let response = response.on_hover_text(help);
        if response.clicked() {
            let tile = usize::from(!ui.input(|input| input.modifiers.shift));
            tradeoff::choose(session, tile, frame.upscaling, commands);
        }
    }

    /// Draws the detail around the picked pixel, one picture pixel per screen pixel.
    fn picture(&mut self, ui: &Ui, rect: Rect, frame: &StripFrame, pick: Option<(u32, u32)>) {
        ui.painter().rect_filled(rect, 0.0, tokens(ui).canvas);
        let place = self.textures.iter().position(|(upscaling, _)| *upscaling == frame.upscaling);
        let place = place.unwrap_or_else(|| {
            self.textures.push((frame.upscaling, FrameTexture::default()));
            self.textures.len() - 1
        });
        let texture = &mut self.textures[place].1;
        let size_px = rect.size() * ui.pixels_per_point();
        let region = detail(pick, frame.picture.size(), (size_px.x as u32, size_px.y as u32));
        let part = texture.part(&frame.picture, region);
        let size = vec2(part.width() as f32, part.height() as f32) / ui.pixels_per_point();
        let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let at = Rect::from_center_size(rect.center(), size);
        ui.painter().image(texture.texture.show(ui, &part), at, uv, Color32::WHITE);
    }
}

/// Returns the index of the picture of the comparison that shows the upscaler, A (0) before B (1).
fn letter_of(upscaling: Upscaling, session: &Session) -> Option<usize> {
    let recipe = |tile| session.state.tiles.recipe(tile, session.state.recipe);
    let is_drawn = |tile: &usize| session.state.tiles.file(PictureRole::Tile(*tile)).is_none();
    (0..2).filter(is_drawn).find(|tile| recipe(*tile).upscaler == upscaling)
}

/// Draws the lists that set scale and order.
fn settings(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = space::XS;
    let strip = &session.features.filmstrip;
    let mut scale = strip.scale;
    let name = |scale: Option<crate::upscale::Scale>| scale.map_or("Largest".to_owned(), |scale| format!("×{scale}"));
    ui.label(egui::RichText::new("All methods").small().color(tokens(ui).text_weak));
    ui.name_inputs("Scale of all methods", |ui| {
        combo("filmstrip scale", &name(scale), SETTINGS_WIDTH).show_ui(ui, |ui| {
            for option in std::iter::once(None).chain(scales().into_iter().map(Some)) {
                ui.selectable_value(&mut scale, option, name(option));
            }
        })
    });
    if scale != strip.scale {
        commands.push(Command::Filmstrip(FilmstripChange::Scale(scale)));
    }
    let order_name = |order| RowOrder::ALL.iter().find(|(known, ..)| *known == order).map_or("", |(_, name, _)| *name);
    let mut order = strip.order;
    ui.name_inputs("Order of all methods", |ui| {
        combo("filmstrip order", &format!("By {}", order_name(order).to_lowercase()), SETTINGS_WIDTH).show_ui(
            ui,
            |ui| {
                for (option, name, help) in RowOrder::ALL {
                    let help = if option == RowOrder::Time {
                        "Sort by median time, fastest first. The panel “Frame time” measures it"
                    } else {
                        help
                    };
                    ui.selectable_value(&mut order, option, format!("By {}", name.to_lowercase())).on_hover_text(help);
                }
            },
        )
    });
    if order != strip.order {
        commands.push(Command::Filmstrip(FilmstripChange::Order(order)));
    }
}
