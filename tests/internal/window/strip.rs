//! Tests of the strip below the picture: its chips, its legends, and the size of the picture above it.

use eframe::egui::{Key, Role};
use egui_kittest::kittest::Queryable as _;
use rasterscope::inspect::Buffer;
use rasterscope::inspect::overlays::Overlay;
use rasterscope::measure::difference::Difference;
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::ui::engine::Shown;
use rasterscope::ui::session::command::Command;
use rasterscope::ui::session::compare::{CompareChange, Mode};
use rasterscope::ui::session::overlays::OverlayChange;
use rasterscope::ui::session::{PictureSize, Session};

use super::bench::Bench;

/// Everything that a chip can remove, as the beginning of the chip's name, the command that activates it, and whether
/// it is active.
type Removable = (&'static str, Command, fn(&Session) -> bool);

fn removables() -> [Removable; 5] {
    [
        ("Remove the overlay: Facing", Command::Overlays(OverlayChange::Toggle(Overlay::Facing)), |session| {
            session.features.overlays.layer(Overlay::Facing).is_some()
        }),
        ("Remove the marks: ", Command::Overlays(OverlayChange::Marks(true)), |session| {
            session.features.overlays.marks
        }),
        ("Show the colour: Depth", Command::Show(Shown::Buffer(Buffer::Depth)), |session| {
            session.shown == Shown::Buffer(Buffer::Depth)
        }),
        ("Draw all triangles: First 5 of ", Command::LimitTriangles(Some(5)), |session| {
            session.features.scrub.triangle_limit.is_some()
        }),
        ("Mirror the scene back: ", Command::MirrorZ, |session| session.mirrored),
    ]
}

#[test]
fn each_chip_removes_what_it_stands_for_and_the_empty_strip_takes_no_space() {
    let mut bench = Bench::small("cubes");
    let (canvas, size) = (bench.canvas(), bench.image().size());
    for (_, command, _) in removables() {
        bench.session_mut().apply(command);
    }
    bench.rest();
    assert!(bench.canvas().height() < canvas.height() && bench.image().size() == size);
    for (name, _, is_active) in removables() {
        assert!(is_active(bench.session()), "{name}");
        bench.window.get_by_label_contains(name).click();
        bench.rest();
        assert!(!is_active(bench.session()), "{name}");
        assert!(bench.window.query_by_label_contains(name).is_none(), "{name}");
    }
    assert_eq!((bench.canvas(), bench.image().size()), (canvas, size));
}

#[test]
fn the_strip_does_not_change_a_picture_that_matches_the_window() {
    let mut bench = Bench::small("triangle");
    bench.session_mut().state.size = PictureSize::MatchWindow;
    bench.rest();
    let size = bench.image().size();
    let canvas = bench.canvas();
    bench.session_mut().apply(Command::Overlays(OverlayChange::Toggle(Overlay::Wireframe)));
    bench.rest();
    assert!(bench.canvas().height() < canvas.height());
    assert_eq!(bench.image().size(), size);
}

#[test]
fn a_scale_lists_the_values_at_its_ends() {
    let mut bench = Bench::small("triangle");
    bench.session_mut().apply(Command::Show(Shown::Buffer(Buffer::Depth)));
    bench.rest();
    let range = bench.view().range.expect("depth has a range");
    assert!(bench.mentions("Colours from ") && range.low < range.high);
    bench.session_mut().apply(Command::Show(Shown::Buffer(Buffer::Color)));
    bench.rest();
    assert!(!bench.mentions("Colours from "));
}

#[test]
fn many_overlays_leave_the_canvas_its_height() {
    let mut bench = Bench::small("triangle");
    let height = bench.canvas().height();
    for overlay in Overlay::ALL {
        bench.session_mut().apply(Command::Overlays(OverlayChange::Toggle(*overlay)));
    }
    bench.rest();
    let left = bench.canvas().height();
    assert!(left < height && left > height - 90.0, "{left} of {height}");
    let last = format!("Remove the overlay: {}", Overlay::ALL[0].name());
    bench.click(&last);
    assert!(bench.session().features.overlays.layer(Overlay::ALL[0]).is_none(), "the strip scrolls to every chip");
}

#[test]
fn the_legend_of_a_difference_is_below_the_picture() {
    let mut bench = Bench::small("cubes");
    bench.press(Key::D);
    let below = |bench: &Bench, text: &str| {
        let picture = bench.window.get_by_role_and_label(Role::Image, "Compared pictures").rect();
        let legend = bench.window.get_by_label_contains(text).rect();
        assert!(legend.top() >= picture.bottom(), "{legend} covers {picture}");
    };
    below(&bench, "Colours from ");
    bench.session_mut().apply(Command::Compare(CompareChange::Difference(Difference::Changed)));
    bench.rest();
    below(&bench, "between A and B");
    bench.session_mut().apply(Command::Compare(CompareChange::Mode(Mode::Wipe)));
    bench.rest();
    assert!(!bench.mentions("between A and B"), "only a difference has a legend");
}
