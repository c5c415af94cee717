use super::*;
use crate::ui::headless::Headless;
use eframe::egui::{DragValue, OutputCommand, PlatformOutput, Pos2, Slider, Theme, pos2};

const FEW: [(u8, &str, &str); 3] = [(0, "Solid", "Fills"), (1, "Wire", "Draws edges"), (2, "Points", "Draws corners")];
const MANY: [(u8, &str, &str); 4] = [
    (0, "Nearest", "Repeats pixels"),
    (1, "Bilinear", "Mixes four"),
    (2, "Catmull–Rom", "Mixes sixteen"),
    (3, "Temporal accumulation", "Gathers samples"),
];

/// Returns a panel 240 points wide, with accessibility enabled.
fn panel() -> Headless {
    let headless = Headless::new(vec2(240.0, 300.0), 1.0, Theme::Dark);
    headless.context().enable_accesskit();
    headless
}

/// Returns the role, name and centre of every named node of the accessibility tree.
fn names(output: PlatformOutput) -> Vec<(Role, String, Pos2)> {
    let nodes = output.accesskit_update.map(|update| update.nodes).unwrap_or_default();
    let named = |(_, node): (_, egui::accesskit::Node)| {
        let name = node.label().or(node.value())?.to_owned();
        let bounds = node.bounds()?;
        Some((node.role(), name, pos2((bounds.x0 + bounds.x1) as f32 / 2.0, (bounds.y0 + bounds.y1) as f32 / 2.0)))
    };
    nodes.into_iter().filter_map(named).collect()
}

fn center_of(names: &[(Role, String, Pos2)], role: Role, name: &str) -> Pos2 {
    let found: Vec<_> = names.iter().filter(|entry| entry.0 == role && entry.1 == name).collect();
    assert_eq!(found.len(), 1, "{role:?} “{name}” among {names:?}");
    found[0].2
}

#[test]
fn controls_of_a_row_are_named_after_its_label() {
    let (mut scale, mut tiles, mut on, mut kind) = (0.5, 32, true, 3);
    let output = panel().pass(Vec::new(), |ui| {
        row(ui, "Scale", "Part of the width.", |ui| ui.add(Slider::new(&mut scale, 0.0..=1.0)));
        row(ui, "Tile", "Side in pixels.", |ui| ui.add(DragValue::new(&mut tiles)));
        row(ui, "Guard band", "Clips late.", |ui| ui.checkbox(&mut on, ""));
        row(ui, "Upscaler", "Enlarges.", |ui| choice(ui, &mut kind, &MANY));
    });
    let names = names(output);
    center_of(&names, Role::Slider, "Scale");
    center_of(&names, Role::SpinButton, "Tile");
    center_of(&names, Role::CheckBox, "Guard band");
    center_of(&names, Role::ComboBox, "Upscaler");
}

#[test]
fn rows_stay_on_the_grid_and_within_the_panel() {
    let mut scale = 0.5;
    panel().pass(Vec::new(), |ui| {
        let panel = ui.max_rect();
        let mut tops = Vec::new();
        tops.push(ui.cursor().top());
        row(ui, "Scale", "", |ui| {
            ui.add(Slider::new(&mut scale, 0.0..=1.0));
            assert!(ui.min_rect().right() <= panel.right(), "a slider and its number fit");
        });
        tops.push(ui.cursor().top());
        let short = value_row(ui, "A label that is much longer than the room that is left", "1.00000000", "").rect;
        tops.push(ui.cursor().top());
        let long = value_row(ui, "Name", &"9".repeat(80), "").rect;
        tops.push(ui.cursor().top());
        assert!(tops.windows(2).all(|pair| pair[1] - pair[0] == theme::ROW_HEIGHT), "{tops:?}");
        assert_eq!(short.right().round(), panel.right());
        assert!(long.left() >= panel.left(), "a value that does not fit is truncated");
    });
}

#[test]
fn a_few_short_options_are_buttons_and_a_click_selects_one() {
    let (mut fill, mut changes) = (0, 0);
    let mut headless = panel();
    let mut ui = |ui: &mut Ui| {
        if row(ui, "Fill", "What is drawn.", |ui| choice(ui, &mut fill, &FEW)) {
            changes += 1;
        }
    };
    let wire = center_of(&names(headless.pass(Vec::new(), &mut ui)), Role::Button, "Wire");
    headless.click(wire, &mut ui);
    headless.click(wire, &mut ui);
    assert_eq!((fill, changes), (1, 1), "selecting the current option changes nothing");
}

#[test]
fn many_or_long_options_are_a_list_and_a_click_selects_one() {
    let mut kind = 0;
    let mut headless = panel();
    let mut ui = |ui: &mut Ui| {
        row(ui, "Upscaler", "Enlarges.", |ui| choice(ui, &mut kind, &MANY));
    };
    let list = center_of(&names(headless.pass(Vec::new(), &mut ui)), Role::ComboBox, "Upscaler");
    headless.click(list, &mut ui);
    headless.pass(Vec::new(), &mut ui);
    let option = center_of(&names(headless.pass(Vec::new(), &mut ui)), Role::Button, "Temporal accumulation");
    headless.click(option, &mut ui);
    assert_eq!(kind, 3);
}

#[test]
fn icons_add_nothing_to_names() {
    let output = panel().pass(Vec::new(), |ui| {
        assert!(!ui.button((theme::icon(Icon::Play), "Play")).clicked());
        icon_button(ui, Icon::RotateCcw, "Reset");
        chip(ui, Status::Rejected, "rejected", "By the depth test.");
        swatch(ui, Color32::from_rgb(230, 120, 40));
        section_header(ui, "Pixel", |_| {});
        empty_state(ui, Icon::MousePointerClick, "No pixel", "Click the picture.");
    });
    let names = names(output);
    let expected = [
        (Role::Button, "Play"),
        (Role::Button, "Reset"),
        (Role::Label, "rejected"),
        (Role::Image, "#E67828"),
        (Role::Label, "Pixel"),
        (Role::Label, "No pixel"),
        (Role::Label, "Click the picture."),
    ];
    for (role, name) in expected {
        center_of(&names, role, name);
    }
}

#[test]
fn a_copy_button_copies_and_confirms() {
    let mut headless = panel();
    let mut ui = |ui: &mut Ui| {
        copy_button(ui, "depth", || "0.25".to_owned());
    };
    let button = center_of(&names(headless.pass(Vec::new(), &mut ui)), Role::Button, "Copy depth");
    let before = headless.picture();
    let output = headless.click(button, &mut ui);
    assert_eq!(output.commands, [OutputCommand::CopyText("0.25".to_owned())]);
    headless.pass(vec![egui::Event::PointerMoved(pos2(200.0, 200.0))], &mut ui);
    headless.pass(Vec::new(), &mut ui);
    assert_ne!(headless.picture(), before, "the icon confirms");
    for _ in 0..20 {
        headless.pass(Vec::new(), &mut ui);
    }
    assert_eq!(headless.picture(), before, "the icon reverts");
}

#[test]
fn every_status_has_an_icon_and_a_colour_of_its_own() {
    let all = [Status::Passed, Status::Rejected, Status::Warning, Status::Error, Status::Neutral];
    for (index, status) in all.iter().enumerate() {
        for other in &all[..index] {
            assert_ne!(status.icon().unicode(), other.icon().unicode());
            assert_ne!(status.color(&theme::DARK), other.color(&theme::DARK));
        }
    }
}

#[test]
fn a_slider_fits_into_a_panel_narrower_than_its_number() {
    let mut headless = Headless::new(vec2(40.0, 300.0), 1.0, Theme::Dark);
    let mut value = 0.5;
    headless.pass(Vec::new(), |ui| {
        row(ui, "Light", "", |ui| slider(ui, &mut value, 0.0..=1.0, "", 1));
    });
    assert_eq!(value, 0.5);
}
