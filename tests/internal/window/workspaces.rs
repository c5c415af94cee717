//! Workspaces: their panels and layouts, and what they must not change.

use eframe::egui::{Key, Modifiers, Role, Vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::workspace::{Panel, Workspace, WorkspaceChange};

use super::bench::{Bench, WINDOW};

fn change(bench: &mut Bench, change: WorkspaceChange) {
    bench.window.state_mut().queue(vec![Command::Workspace(change)]);
    bench.rest();
}

/// Whether a panel is on screen.
fn shows(bench: &Bench, panel: Panel) -> bool {
    bench.window.query_by_role_and_label(Role::Group, panel.name()).is_some()
}

/// Returns the area of the canvas as a share of the window.
fn canvas_share(bench: &Bench, window: Vec2) -> f32 {
    bench.canvas().area() / (window.x * window.y)
}

fn resize(bench: &mut Bench, window: Vec2) {
    bench.window.set_size(window);
    bench.rest();
}

#[test]
fn keys_show_workspaces_and_every_panel_can_be_shown() {
    let mut bench = Bench::small("triangle");
    let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];
    for (workspace, key) in Workspace::ALL.iter().copied().zip(keys) {
        bench.press_with(Modifiers::COMMAND, key);
        assert_eq!(bench.session().workspace(), workspace);
    }
    for panel in Panel::ALL {
        bench.show_panel(*panel);
        assert!(shows(&bench, *panel), "{panel:?}");
    }
}

#[test]
fn a_comparison_has_the_same_figures_in_every_mode_layout_and_window() {
    let mut bench = Bench::small("chess");
    bench.press(Key::T);
    let figures = |bench: &Bench| {
        let compared = bench.session().features.comparison.compared.as_ref().expect("something is compared");
        let measured = compared.tiles[1].measured.as_ref().expect("B is measured");
        let figures = measured.figures.expect("B has the size of the reference");
        (compared.tiles[1].picture.size(), figures.codes.psnr_db, figures.codes.ssim, figures.flip)
    };
    let first = figures(&bench);
    assert!(first.1.is_finite(), "the pictures differ");
    for key in [Key::W, Key::B, Key::D] {
        bench.press(key);
        assert_eq!(figures(&bench), first, "{key:?}");
    }
    for window in [Vec2::new(1024.0, 700.0), Vec2::new(1920.0, 1080.0), WINDOW] {
        resize(&mut bench, window);
        assert_eq!(figures(&bench), first, "{window}");
    }
    bench.press(Key::F9);
    assert!(shows(&bench, Panel::Stages), "the panels are shown");
    assert_eq!(figures(&bench), first);
    for workspace in Workspace::ALL.iter().copied() {
        change(&mut bench, WorkspaceChange::Show(workspace));
        change(&mut bench, WorkspaceChange::Show(Workspace::Compare));
        assert_eq!(figures(&bench), first, "{workspace:?}");
    }
}

#[test]
fn the_pick_and_the_picture_stay_in_every_workspace_and_window() {
    let mut bench = Bench::small("chess");
    let (pick, picture) = (bench.session().pick, bench.image());
    assert!(pick.is_some());
    let point = bench.session().features.picking.point.clone().expect("a triangle is picked");
    for window in [Vec2::new(900.0, 560.0), Vec2::new(1920.0, 1080.0)] {
        resize(&mut bench, window);
        for workspace in Workspace::ALL.iter().copied() {
            change(&mut bench, WorkspaceChange::Show(workspace));
            assert_eq!((bench.session().pick, &bench.image()), (pick, &picture), "{workspace:?} {window}");
            let now = bench.session().features.picking.point.as_ref().expect("it is kept");
            assert_eq!((now.triangle, now.weights), (point.triangle, point.weights));
        }
    }
}

#[test]
fn the_picture_has_most_of_the_window() {
    let mut bench = Bench::small("triangle");
    for (window, least) in [(WINDOW, 0.5), (Vec2::new(1024.0, 700.0), 0.4), (Vec2::new(1920.0, 1080.0), 0.6)] {
        resize(&mut bench, window);
        let share = canvas_share(&bench, window);
        assert!(share >= least, "{window}: {share}");
        change(&mut bench, WorkspaceChange::TogglePanels);
        assert!(!shows(&bench, Panel::Pixel) && canvas_share(&bench, window) > 0.8);
        change(&mut bench, WorkspaceChange::TogglePanels);
        assert_eq!(canvas_share(&bench, window), share);
    }
}

#[test]
fn a_picture_in_16_9_fills_most_of_the_canvas() {
    let mut bench = Bench::small("triangle");
    for (window, least) in [(WINDOW, 0.55), (Vec2::new(1024.0, 700.0), 0.44), (Vec2::new(1920.0, 1080.0), 0.7)] {
        resize(&mut bench, window);
        let canvas = bench.canvas().size();
        let width = canvas.x.min(canvas.y * 16.0 / 9.0);
        let share = width * width * 9.0 / 16.0 / (window.x * window.y);
        assert!(share >= least, "{window}: {share}");
        for panel in [Panel::Stages, Panel::Pixel] {
            let place = bench.window.get_by_role_and_label(Role::Group, panel.name()).rect();
            assert!(place.width() >= 240.0 && place.height() >= 240.0, "{window}: {panel:?} {place}");
        }
    }
}

#[test]
fn a_comparison_has_three_quarters_of_the_window() {
    let mut bench = Bench::small("triangle");
    bench.press_with(Modifiers::COMMAND, Key::Num3);
    for window in [WINDOW, Vec2::new(1024.0, 700.0), Vec2::new(1920.0, 1080.0)] {
        resize(&mut bench, window);
        let pictures = bench.window.query_all_by_role(Role::Image);
        let tiles =
            pictures.filter(|node| node.accesskit_node().label().is_some_and(|name| name.starts_with("Picture ")));
        let area = tiles.map(|node| node.rect().area()).sum::<f32>();
        let share = area / (window.x * window.y);
        assert!(share >= 0.75, "{window}: {share}");
    }
}

#[test]
fn a_title_maximizes_its_panel_and_the_layout_returns() {
    let mut bench = Bench::small("triangle");
    let before = bench.canvas();
    bench.click("Maximize “Pixel”");
    assert!(shows(&bench, Panel::Pixel) && !shows(&bench, Panel::Picture) && !shows(&bench, Panel::Stages));
    bench.click("Restore the layout around “Pixel”");
    assert_eq!(bench.canvas(), before);
    bench.click("Histogram");
    assert!(shows(&bench, Panel::Histogram) && !shows(&bench, Panel::Stages));
    change(&mut bench, WorkspaceChange::ResetLayout);
    assert!(shows(&bench, Panel::Stages));
}

#[test]
fn f6_leads_through_all_panels() {
    let mut bench = Bench::small("triangle");
    let focused = |bench: &Bench| {
        let node = bench.window.query_all_by_role(Role::Group).find(egui_kittest::Node::is_focused);
        node.and_then(|node| node.accesskit_node().label())
    };
    let mut names = Vec::new();
    for _ in 0..4 {
        bench.press(Key::F6);
        names.push(focused(&bench).expect("a panel has the focus"));
    }
    assert_eq!(names, ["Picture", "Stages", "Pixel", "Picture"]);
}
