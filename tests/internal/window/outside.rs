//! Tests of the mesh view, the vertex panel and the stability probe.

use std::time::{Duration, Instant};

use eframe::egui::{Key, PointerButton, Role, Vec2};
use egui_kittest::kittest::Queryable as _;
use rasterscope::ui::session::vertices::picked_triangle;
use rasterscope::ui::session::workspace::Panel;

use super::bench::Bench;

fn pane(bench: &Bench) -> eframe::egui::Rect {
    bench.window.get_by_role_and_label(Role::Image, "Mesh view").rect()
}

#[test]
fn m_opens_the_mesh_view_and_a_click_there_picks_a_pixel_of_the_triangle() {
    let mut bench = Bench::small("triangle");
    let alone = bench.canvas().width();
    bench.press(Key::M);
    assert!(bench.session().features.mesh_view.open && bench.canvas().width() < alone);
    let place = pane(&bench);
    let camera = bench.session().features.mesh_view.camera.expect("the mesh view has a camera");
    let inner = bench.session().state.camera;
    bench.press(Key::Escape);
    assert_eq!(bench.session().pick, None);
    // Clicks a grid of positions until one hits the only triangle of the scene.
    let mut places = (1..20).flat_map(|x| (1..20).map(move |y| Vec2::new(x as f32, y as f32) / 20.0));
    let hit = places.find(|share| {
        bench.click_at(place.min + place.size() * *share);
        bench.session().pick.is_some()
    });
    assert!(hit.is_some());
    assert_eq!(picked_triangle(bench.session()).map(|id| id.0), Some(0));
    assert_eq!(bench.view().report.as_ref().and_then(|report| Some(report.visible()?.triangle.0)), Some(0));

    bench.drag(PointerButton::Primary, place.center(), Vec2::new(50.0, 20.0));
    assert_ne!(bench.session().features.mesh_view.camera, Some(camera));
    assert_eq!(bench.session().state.camera, inner, "the render camera does not move");
    bench.press(Key::M);
    assert!(!bench.session().features.mesh_view.open);
}

#[test]
fn a_row_of_the_vertex_table_is_selected_until_it_is_clicked_again() {
    let mut bench = Bench::small("triangle");
    bench.show_panel(Panel::Vertices);
    assert!(bench.mentions("triangle 0 of"));
    for expected in [Some((0, 1)), None] {
        bench.click("Vertex 1");
        assert_eq!(bench.session().features.vertices.selected, expected);
    }
}

#[test]
fn the_probe_runs_and_picks_the_pixel_that_changed_most() {
    /// Time limit of the probe, sufficient for slow machines.
    const PATIENCE: Duration = Duration::from_secs(120);
    let mut bench = Bench::small("z-fighting");
    bench.session_mut().features.probing.probe.runs = 4;
    bench.session_mut().features.probing.probe.ulps = 32;
    bench.show_panel(Panel::Probe);
    assert!(bench.says("No probe results yet"));
    bench.click("Run the probe");
    let begun = Instant::now();
    while bench.session().features.probing.found.is_none() {
        assert!(begun.elapsed() < PATIENCE, "it does not end");
        std::thread::sleep(Duration::from_millis(20));
        bench.window.step();
    }
    bench.rest();
    let worst = bench.session().features.probing.found.as_ref().expect("it was found").findings.ranking[0];
    bench.click(&format!("Go to the worst pixel of triangle {}", worst.triangle.0));
    assert_eq!(bench.session().pick, Some(worst.worst_pixel));
    assert!(bench.session().features.probing.picture(bench.view()).is_some());
    bench.click("Hidden");
    assert!(bench.session().features.probing.picture(bench.view()).is_none());
}

#[test]
fn the_menu_of_marks_draws_normals_and_sets_their_length() {
    let mut bench = Bench::small("triangle");
    bench.press(Key::M);
    assert!(!bench.session().features.mesh_view.normals.vertices);
    bench.click("Marks");
    bench.window.get_by_role_and_label(Role::CheckBox, "Vertex normals").click();
    bench.rest();
    bench.window.get_by_role_and_label(Role::Slider, "Length of normals").set_value_accesskit(0.2);
    bench.rest();
    let normals = bench.session().features.mesh_view.normals;
    assert!(normals.vertices && !normals.faces && (normals.length - 0.2).abs() < 1e-3, "{normals:?}");
}
