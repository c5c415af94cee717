//! Controls of the lab's pages, one file each.

mod circles;

mod lines;

mod polygons;

mod primitives;

mod sampling;

mod seed_fills;

mod triangles;

use eframe::egui::{RichText, Ui};

use crate::lab::Lesson;
use crate::pipeline::settings::Choice;
use crate::ui::session::lab::{Lab, LabChange};
use crate::ui::theme::{space, tokens};
use crate::ui::widgets::section_header;

/// Draws the controls of the current page.
pub(super) fn controls(ui: &mut Ui, lab: &Lab, changes: &mut Vec<LabChange>) {
    let mut lesson = lab.lesson().clone();
    match &mut lesson {
        Lesson::Lines(lines) => lines::ui(ui, lines),
        Lesson::Circles(circles) => circles::ui(ui, circles),
        Lesson::Polygons(polygons) => polygons::ui(ui, polygons),
        Lesson::SeedFill(fills) => {
            let mut brush = lab.brush;
            seed_fills::ui(ui, fills, &mut brush);
            if brush != lab.brush {
                changes.push(LabChange::Brush(brush));
            }
        }
        Lesson::Primitives(primitives) => primitives::ui(ui, primitives),
        Lesson::Triangles(triangles) => triangles::ui(ui, triangles),
        Lesson::Sampling(sampling) => sampling::ui(ui, sampling),
    }
    if lesson != *lab.lesson() {
        changes.push(LabChange::Set(Box::new(lesson)));
    }
}

/// Draws a title and, below it, all options of a setting as radio buttons with help texts.
fn list<C: Choice>(ui: &mut Ui, title: &str, value: &mut C) {
    section_header(ui, title, |_| {});
    for choice in C::ALL {
        ui.radio_value(value, *choice, choice.name()).on_hover_text(choice.help());
    }
}

/// Draws a button for each preset. Returns the one that was clicked.
fn presets<C: Choice>(ui: &mut Ui) -> Option<C> {
    section_header(ui, "Presets", |_| {});
    let mut clicked = None;
    ui.horizontal_wrapped(|ui| {
        for choice in C::ALL {
            if ui.button(choice.name()).on_hover_text(choice.help()).clicked() {
                clicked = Some(*choice);
            }
        }
    });
    clicked
}

/// Draws a hint that explains how to use the mouse on a page.
fn hint(ui: &mut Ui, text: &str) {
    ui.add_space(space::S);
    ui.label(RichText::new(text).color(tokens(ui).text_weak).small());
}
