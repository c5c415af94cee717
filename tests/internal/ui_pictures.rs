//! Pictures of the whole workbench, painted without a display. Everything independent of the clock is identical in
//! every run, and the canvas shows the pixels of the frame unchanged.

use std::sync::Arc;

use eframe::egui::accesskit::{Node, NodeId, Role, TreeUpdate};
use eframe::egui::{self, Pos2, Rect, Vec2, pos2};
use rasterscope::chain::Recipe;
use rasterscope::image::{Image, Rgba8};
use rasterscope::inspect::Stage;
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::pipeline::viewport::Viewport;
use rasterscope::scene::{MemoryLimit, SceneSource};
use rasterscope::ui::app::Workbench;
use rasterscope::ui::headless::Headless;
use rasterscope::ui::session::{PictureSize, Session};
use rasterscope::ui::worker::Worker;
use rasterscope::ui::{InitialView, ScreenshotRequest, Theme, WindowStart, screenshot};

/// Tested windows.
const WINDOWS: [TestWindow; 6] = [
    TestWindow { width: 1280.0, height: 800.0, pixels_per_point: 1.0 },
    TestWindow { width: 1920.0, height: 1080.0, pixels_per_point: 1.0 },
    TestWindow { width: 900.0, height: 560.0, pixels_per_point: 1.0 },
    TestWindow { width: 1920.0, height: 1080.0, pixels_per_point: 1.5 },
    TestWindow { width: 1280.0, height: 800.0, pixels_per_point: 1.25 },
    TestWindow { width: 2560.0, height: 1600.0, pixels_per_point: 2.0 },
];

/// Number of egui passes after which the layout has settled.
const PASSES: usize = 6;

/// Window without a display.
#[derive(Clone, Copy, Debug)]
struct TestWindow {
    /// Width in screen pixels.
    width: f32,
    /// Height in screen pixels.
    height: f32,
    pixels_per_point: f32,
}

/// A workbench without a display, after the passes in which its layout settles.
struct Shot {
    app: Workbench,
    headless: Headless,
    pixels_per_point: f32,
    tree: TreeUpdate,
}

impl Shot {
    fn new(scene: &str, window: TestWindow, theme: egui::Theme) -> Self {
        let TestWindow { width, height, pixels_per_point } = window;
        let source = SceneSource::named(scene.into());
        let scene = source.load().unwrap().scene;
        let camera = scene.home;
        let mut session = Session::new(Arc::new(scene), source, Recipe::default(), camera);
        session.state.size = PictureSize::MatchWindow;
        let headless = Headless::new(Vec2::new(width, height) / pixels_per_point, pixels_per_point, theme);
        headless.context().enable_accesskit();
        let app = Workbench::new(session, Worker::inline());
        let mut shot = Self { app, headless, pixels_per_point, tree: TreeUpdate::default_empty() };
        shot.passes();
        shot
    }

    fn passes(&mut self) {
        for _ in 0..PASSES {
            let output = self.headless.pass(Vec::new(), |ui| self.app.show(ui));
            self.tree = output.accesskit_update.expect("accessibility is on");
        }
    }

    /// Returns all accessibility nodes that have bounds, with their rectangles in points.
    fn placed(&self) -> impl Iterator<Item = (NodeId, &Node, Rect)> {
        self.tree.nodes.iter().filter_map(|(id, node)| {
            let bounds = node.bounds()?;
            let rect =
                Rect::from_min_max(pos2(bounds.x0 as f32, bounds.y0 as f32), pos2(bounds.x1 as f32, bounds.y1 as f32));
            Some((*id, node, rect))
        })
    }

    /// Returns the rectangle of the only node with this role and name, in points. Panics unless there is exactly one.
    fn place_of(&self, role: Role, name: &str) -> Rect {
        let mut found = self.placed().filter(|(_, node, _)| node.role() == role && node.label() == Some(name));
        let (_, _, rect) = found.next().unwrap_or_else(|| panic!("there is no node {name}"));
        assert!(found.next().is_none(), "there are two nodes {name}");
        rect
    }

    /// Returns the rectangle of the first label with this text, in points. Panics if there is none.
    fn place_of_text(&self, text: &str) -> Rect {
        let mut labels = self.placed().filter(|(_, node, _)| node.role() == Role::Label && node.value() == Some(text));
        labels.next().unwrap_or_else(|| panic!("there is no label {text}")).2
    }

    fn canvas(&self) -> Rect {
        self.place_of(Role::Image, "Rendered picture")
    }

    fn window(&self) -> Rect {
        self.headless.context().content_rect()
    }

    /// Returns the part of the window's picture that shows the frame, and the picture of the frame.
    fn canvas_and_frame(&self) -> (Image<Rgba8>, Image<Rgba8>) {
        let frame = self.app.session().view.as_ref().expect("a frame was drawn").frame.image();
        let picture = self.headless.picture();
        let corner = (self.canvas().min * self.pixels_per_point).round();
        let (width, height) = frame.size();
        let crop = Image::from_fn(width, height, |x, y| picture.at(corner.x as u32 + x, corner.y as u32 + y));
        (crop, (*frame).clone())
    }
}

/// Type with an empty value; implemented for accessibility trees.
trait DefaultEmpty {
    fn default_empty() -> Self;
}

impl DefaultEmpty for TreeUpdate {
    fn default_empty() -> Self {
        let tree_id = eframe::egui::accesskit::TreeId::ROOT;
        Self { nodes: Vec::new(), tree: None, tree_id, focus: NodeId(0) }
    }
}

#[test]
fn the_canvas_shows_the_frame_s_own_pixels() {
    for window in WINDOWS {
        for theme in [egui::Theme::Dark, egui::Theme::Light] {
            let mut shot = Shot::new("triangle", window, theme);
            // The marker of the picked pixel would cover the picture.
            shot.app.session_mut().pick = None;
            shot.passes();
            let (shown, frame) = shot.canvas_and_frame();
            assert!(frame.pixels().iter().any(|p| *p != frame.at(0, 0)), "there is something in the picture");
            let differing = (0..frame.height()).flat_map(|y| (0..frame.width()).map(move |x| (x, y)));
            let differing: Vec<_> = differing.filter(|(x, y)| shown.at(*x, *y) != frame.at(*x, *y)).collect();
            assert!(differing.is_empty(), "{window:?} {theme:?}: {} pixels, first {:?}", differing.len(), differing[0]);
        }
    }
}

#[test]
fn the_picked_pixel_is_marked_around_it_and_not_on_it() {
    let mut shot = Shot::new("triangle", WINDOWS[0], egui::Theme::Dark);
    let (x, y) = (200, 150);
    shot.app.session_mut().pick = Some((x, y));
    shot.passes();
    let (shown, frame) = shot.canvas_and_frame();
    assert_eq!(shown.at(x, y), frame.at(x, y));
    let near = |px: u32, py: u32| px.abs_diff(x) <= 20 && py.abs_diff(y) <= 20;
    let mut changed = 0;
    for py in 0..frame.height() {
        for px in 0..frame.width() {
            if shown.at(px, py) != frame.at(px, py) {
                assert!(near(px, py), "{px}, {py}");
                changed += 1;
            }
        }
    }
    assert!(changed > 40, "the marker is visible");
}

#[test]
fn two_runs_differ_only_in_live_numbers() {
    let (a, b) = (Shot::new("cubes", WINDOWS[0], egui::Theme::Dark), Shot::new("cubes", WINDOWS[0], egui::Theme::Dark));
    // Times appear in the menu bar and in the rows of the pipeline, where they determine the bars and the columns.
    let rows = a.place_of(Role::Button, "Assemble stage").union(a.place_of_text("Whole frame"));
    let mut live = vec![rows.expand(2.0)];
    for (here, there) in [(&a, &b), (&b, &a)] {
        for (id, node, rect) in here.placed().filter(|(_, _, rect)| !rows.contains_rect(*rect)) {
            let same = there.placed().any(|(i, n, r)| i == id && n.value() == node.value() && r == rect);
            if !same {
                let value = node.value().unwrap_or_default();
                let moved_in_menu = rect.bottom() < here.place_of(Role::Button, "File").bottom() + 4.0;
                assert!(value.ends_with("ms") || moved_in_menu, "`{value}` is not a time");
                live.push(rect.expand(2.0));
            }
        }
    }
    let (first, second) = (a.headless.picture(), b.headless.picture());
    let is_live = |x: u32, y: u32| live.iter().any(|rect| rect.contains(Pos2::new(x as f32 + 0.5, y as f32 + 0.5)));
    // Other digits change the positions of shared glyphs in the glyph texture, where sampling may round differently.
    let same = |a: Rgba8, b: Rgba8| a.iter().zip(b).all(|(a, b)| a.abs_diff(b) <= 1);
    for y in 0..first.height() {
        for x in 0..first.width() {
            assert!(same(first.at(x, y), second.at(x, y)) || is_live(x, y), "{x}, {y} differs");
        }
    }
}

#[test]
fn light_and_dark_differ_around_the_canvas_and_not_on_it() {
    let [dark, light] = [egui::Theme::Dark, egui::Theme::Light].map(|theme| {
        let mut shot = Shot::new("triangle", WINDOWS[0], theme);
        shot.app.session_mut().pick = None;
        shot.passes();
        shot
    });
    assert!(dark.canvas_and_frame().0 == light.canvas_and_frame().0);
    let canvas = dark.canvas();
    let (dark, light) = (dark.headless.picture(), light.headless.picture());
    let differing = dark.pixels().iter().zip(light.pixels()).filter(|(a, b)| a != b).count();
    let around = dark.pixels().len() - canvas.area() as usize;
    assert!(differing * 2 > around, "panels change: {differing} of {around}");
    assert!(light.pixels().iter().all(|pixel| pixel[3] == 255), "nothing is left unpainted");
}

#[test]
fn all_stages_stand_in_order_below_one_another() {
    for window in WINDOWS {
        let shot = Shot::new("triangle", window, egui::Theme::Dark);
        let rows: Vec<_> =
            Stage::ALL.iter().map(|s| shot.place_of(Role::Button, &format!("{} stage", s.name()))).collect();
        assert_eq!(rows.len(), 10);
        for pair in rows.windows(2) {
            assert!(pair[0].bottom() <= pair[1].top(), "{window:?}: {pair:?}");
        }
        for row in &rows {
            let is_beside = row.right() < shot.canvas().left() || row.left() > shot.canvas().right();
            assert!(row.left() >= 0.0 && row.right() <= shot.window().right() && is_beside, "{window:?}: {row:?}");
        }
        assert!(shot.window().contains_rect(rows[0]), "{window:?}");
    }
    let large =
        Shot::new("triangle", TestWindow { width: 1920.0, height: 1080.0, pixels_per_point: 1.0 }, egui::Theme::Dark);
    for stage in Stage::ALL {
        let row = large.place_of(Role::Button, &format!("{} stage", stage.name()));
        assert!(large.window().contains_rect(row), "{}", stage.name());
    }
}

#[test]
fn the_rows_of_the_pipeline_fit_without_scrolling() {
    // A narrow window has the narrowest panel.
    for width in [WINDOWS[0].width, 794.0] {
        let shot = Shot::new("interpenetrating", TestWindow { width, ..WINDOWS[0] }, egui::Theme::Light);
        let last = shot.place_of_text("Whole frame");
        assert!(shot.window().contains_rect(last), "{width}: {last:?}");
        let first = shot.place_of(Role::Button, "Assemble stage");
        assert!(shot.window().contains_rect(first) && first.bottom() <= last.top(), "{width}: {first:?}");
        let eye = shot.place_of(Role::Button, "Show the picture after “Transform”");
        let times: Vec<_> =
            shot.placed().filter(|(_, node, _)| node.value().is_some_and(|v| v.ends_with("ms"))).collect();
        let in_rows = times.iter().filter(|(_, _, rect)| first.union(last).contains_rect(*rect));
        let rights: Vec<_> = in_rows.map(|(_, _, rect)| rect.right()).collect();
        assert!(rights.len() > 5 && rights.iter().all(|right| *right == rights[0]), "{width}: {rights:?}");
        assert!(rights[0] < eye.left(), "{width}: {eye:?}");
    }
}

#[test]
fn controls_do_not_overlap_and_stay_within_the_window() {
    for window in WINDOWS {
        let shot = Shot::new("triangle", window, egui::Theme::Dark);
        let menu = shot.place_of(Role::Button, "File").bottom();
        let is_control = |role| matches!(role, Role::Button | Role::ComboBox | Role::Slider | Role::CheckBox);
        // Panels scroll; the menu and the bars above and below the canvas do not.
        let canvas = shot.canvas();
        let fixed =
            |rect: &Rect| rect.bottom() <= menu || (rect.left() >= canvas.left() && rect.left() < canvas.right());
        let controls: Vec<_> = shot
            .placed()
            .filter(|(_, node, rect)| (is_control(node.role()) || node.role() == Role::Label) && fixed(rect))
            .map(|(_, node, rect)| (node.label().or(node.value()).unwrap_or_default().to_owned(), rect))
            .collect();
        assert!(controls.len() > 15, "{window:?}: {}", controls.len());
        for (i, (name, rect)) in controls.iter().enumerate() {
            assert!(shot.window().contains_rect(*rect), "{window:?}: {name} {rect:?}");
            if rect.bottom() > menu {
                assert!(rect.right() <= canvas.right(), "{window:?}: {name} is cut off");
            }
            for (other, other_rect) in &controls[..i] {
                let common = rect.shrink(0.5).intersect(other_rect.shrink(0.5));
                assert!(!common.is_positive(), "{window:?}: {name} lies over {other}");
            }
        }
    }
}

#[test]
fn a_screenshot_has_the_requested_size() {
    let source = SceneSource::named("triangle".into());
    let scene = Arc::new(source.load().unwrap().scene);
    let camera = scene.home;
    for (width, height, pixels_per_point) in [(640, 480, 1.0), (901, 563, 1.5), (333, 222, 0.75)] {
        let start = WindowStart {
            source: source.clone(),
            scene: scene.clone(),
            warnings: Vec::new(),
            recipe: Recipe::default(),
            camera,
            mirrored: false,
            resume: false,
            memory_limit: MemoryLimit::default(),
            pending: None,
            project: None,
            initial_view: InitialView::default(),
        };
        let size = Viewport { width, height };
        let request = ScreenshotRequest {
            start,
            size,
            pixels_per_point,
            theme: Theme::Light,
            selected: None,
            measure: false,
            probe: false,
            mesh: None,
            compare: None,
            workspace: None,
            panel: None,
            shown: None,
            moment: None,
            fate: None,
            lab: None,
            first: Vec::new(),
        };
        assert_eq!(screenshot(&request).map(|image| image.size()), Ok((width, height)));
        let outside = ScreenshotRequest { selected: Some((1280, 0)), ..request };
        assert_eq!(screenshot(&outside), Err(Viewport { width: 1280, height: 720 }));
    }
}
