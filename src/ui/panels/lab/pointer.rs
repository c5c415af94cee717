//! Pointer input on the grid: drags handles, adds and removes polygon corners, paints pixels, and selects a pixel.

use eframe::egui::{CursorIcon, Id, PointerButton, Pos2, Response, Ui};
use glam::DVec2;

use super::grid_view::{GridView, HANDLE};
use crate::flat2d::line::midpoint_line;
use crate::lab::Lesson;
use crate::lab::seed_fills::Paint;
use crate::ui::session::lab::{Lab, LabChange};

/// Radius within which the pointer grabs a handle, in points.
const REACH: f32 = HANDLE + 5.0;

/// Returns the id under which egui stores the dragged handle between passes.
fn grabbed_id() -> Id {
    Id::unique("grabbed handle of the lab")
}

fn grabbed(ui: &Ui) -> Option<usize> {
    ui.data(|data| data.get_temp(grabbed_id()))
}

/// Whether a drag pans the view: with the middle button, or with the primary button if it drags nothing else.
pub(super) fn drags_view(ui: &Ui, response: &Response, lab: &Lab) -> bool {
    let paints = matches!(lab.lesson(), Lesson::SeedFill(_));
    response.dragged_by(PointerButton::Middle)
        || response.dragged_by(PointerButton::Primary) && !paints && grabbed(ui).is_none() && !response.drag_started()
}

/// Handles pointer input on the grid.
pub(super) fn ui(ui: &Ui, response: &Response, view: GridView, lab: &Lab, changes: &mut Vec<LabChange>) {
    let mut lesson = lab.lesson().clone();
    let under = |at: Pos2| nearest_handle(lab.lesson(), view, at);
    if response.drag_started_by(PointerButton::Primary)
        && let Some(handle) = ui.input(|i| i.pointer.press_origin()).and_then(under)
    {
        ui.data_mut(|data| data.insert_temp(grabbed_id(), handle));
    }
    act(ui, response, view, &mut lesson, lab.brush);
    if !response.dragged_by(PointerButton::Primary) {
        ui.data_mut(|data| data.remove::<usize>(grabbed_id()));
    }
    if response.hover_pos().and_then(under).is_some() || grabbed(ui).is_some() {
        ui.set_cursor_icon(CursorIcon::Grab);
    }
    if lesson != *lab.lesson() {
        changes.push(LabChange::Set(Box::new(lesson)));
    }
}

/// Applies clicks and drags to the lesson.
fn act(ui: &Ui, response: &Response, view: GridView, lesson: &mut Lesson, brush: Paint) {
    let Some(at) = response.interact_pointer_pos() else { return };
    let (place, under) = (view.place(at), nearest_handle(lesson, view, at));
    if response.dragged_by(PointerButton::Primary)
        && let Some(handle) = grabbed(ui)
    {
        lesson.move_handle(handle, place);
        return;
    }
    match lesson {
        Lesson::Polygons(polygon) => {
            if response.double_clicked() && under.is_none() {
                polygon.add_corner((place * 2.0).round() / 2.0);
            } else if response.secondary_clicked()
                && let Some(handle) = under
            {
                polygon.remove_corner(handle);
            }
        }
        Lesson::SeedFill(fill) => {
            let with = |button| response.dragged_by(button) || response.clicked_by(button);
            let paint = if with(PointerButton::Primary) {
                Some(brush)
            } else {
                with(PointerButton::Secondary).then_some(Paint::Paper)
            };
            if let Some(paint) = paint {
                // Paints the line from the last pass's position to this one, because a fast pointer skips pixels.
                let before = view.place(at - ui.input(|i| i.pointer.delta()));
                stroke(before, place).for_each(|pixel| fill.paint(pixel, paint));
            }
        }
        Lesson::Sampling(sampling) => {
            if let (true, Some(pixel)) = (response.clicked(), pixel(place)) {
                sampling.choose(pixel);
            }
        }
        Lesson::Lines(_) | Lesson::Circles(_) | Lesson::Primitives(_) | Lesson::Triangles(_) => {}
    }
}

/// Returns an iterator over the pixels on the line between two positions on the grid, in pixels.
fn stroke(from: DVec2, to: DVec2) -> impl Iterator<Item = (u32, u32)> {
    let cell = |place: DVec2| (place.x.floor() as i64, place.y.floor() as i64);
    midpoint_line(cell(from), cell(to)).filter_map(|(x, y)| Some((x.try_into().ok()?, y.try_into().ok()?)))
}

fn pixel(place: DVec2) -> Option<(u32, u32)> {
    (place.x >= 0.0 && place.y >= 0.0).then_some((place.x as u32, place.y as u32))
}

fn nearest_handle(lesson: &Lesson, view: GridView, at: Pos2) -> Option<usize> {
    let handles = lesson.handles().into_iter().enumerate();
    let near =
        handles.map(|(number, place)| (number, view.screen(place).distance(at))).filter(|(_, far)| *far <= REACH);
    near.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(number, _)| number)
}
