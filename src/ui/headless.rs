//! User interface without a window: runs passes with a fixed time step and given events, and renders the last pass to
//! an image.
//!
//! Screenshots and tests run through this module. Apart from timed passes, nothing reads a clock or a display, so the
//! same interface yields the same bytes every time. The interface is a closure that takes the root [`egui::Ui`] of a
//! window. For example, `headless.pass(vec![], |ui| app.show(ui))` draws an application whose `eframe::App::ui` calls
//! `self.show(ui)`.

use std::time::{Duration, Instant};

use eframe::egui::{
    self, Event, FullOutput, PlatformOutput, Pos2, RawInput, Rect, Vec2, ViewportId,
    epaint::{ClippedShape, Primitive},
};

use super::{cpu_painter::CpuPainter, theme};
use crate::image::{Image, Rgba8};

/// Time between two passes, in seconds. All animations of the theme finish within two passes.
pub(crate) const STEP_SECONDS: f64 = 0.1;

/// Maximum side length of a texture that egui may request, in texels. It equals the maximum side length of a picture.
const LARGEST_TEXTURE_SIDE: usize = 16_384;

/// CPU cost of one pass of the user interface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PassCost {
    /// Time spent laying out panels and text and handling input.
    pub(crate) layout: Duration,
    /// Time spent tessellating shapes into triangles.
    pub(crate) tessellation: Duration,
    /// Number of vertices of the tessellated triangles.
    pub(crate) vertices: usize,
    /// Size of the textures uploaded in this pass, in bytes.
    pub(crate) texture_bytes: usize,
}

/// User interface without a window: an egui context with the theme, its painter, and the shapes of its last pass.
pub(crate) struct Headless {
    context: egui::Context,
    painter: CpuPainter,
    size_points: Vec2,
    pixels_per_point: f32,
    pass_count: u32,
    shapes: Vec<ClippedShape>,
}

impl Headless {
    /// Creates an interface of `size_points` logical points, with `pixels_per_point` physical pixels per point.
    pub(crate) fn new(size_points: Vec2, pixels_per_point: f32, theme: egui::Theme) -> Self {
        let context = egui::Context::default();
        theme::install(&context);
        context.set_theme(theme);
        Self {
            context,
            painter: CpuPainter::default(),
            size_points,
            pixels_per_point,
            pass_count: 0,
            shapes: Vec::new(),
        }
    }

    /// Returns the egui context, for further setup.
    #[cfg(test)]
    pub(crate) fn context(&self) -> &egui::Context {
        &self.context
    }

    /// Runs one pass with `events` as its input. Returns its output for the platform, such as cursor, clipboard and
    /// accessibility tree.
    pub(crate) fn pass(&mut self, events: Vec<Event>, ui: impl FnMut(&mut egui::Ui)) -> PlatformOutput {
        let input = self.input(events);
        let FullOutput { platform_output, mut textures_delta, shapes, .. } = self.context.run_ui(input, ui);
        self.painter.handle_delta(&mut textures_delta);
        self.pass_count += 1;
        self.shapes = shapes;
        platform_output
    }

    /// Runs one pass with `events` as its input. Returns its CPU cost up to the point where a GPU would take over.
    pub(crate) fn timed_pass(&mut self, events: Vec<Event>, ui: impl FnMut(&mut egui::Ui)) -> PassCost {
        let input = self.input(events);
        let begun = Instant::now();
        let FullOutput { mut textures_delta, shapes, pixels_per_point, .. } = self.context.run_ui(input, ui);
        let layout = begun.elapsed();
        let images = textures_delta.set.values().flatten().map(|delta| delta.image.width() * delta.image.height());
        let texture_bytes = images.sum::<usize>() * size_of::<egui::Color32>();
        self.painter.handle_delta(&mut textures_delta);
        self.pass_count += 1;
        self.shapes.clone_from(&shapes);
        let begun = Instant::now();
        let primitives = self.context.tessellate(shapes, pixels_per_point);
        let tessellation = begun.elapsed();
        let vertices = primitives.iter().map(|clipped| match &clipped.primitive {
            Primitive::Mesh(mesh) => mesh.vertices.len(),
            Primitive::Callback(_) => 0,
        });
        PassCost { layout, tessellation, vertices: vertices.sum(), texture_bytes }
    }

    /// Clicks with the primary mouse button at `position`, in points. Takes three passes.
    #[cfg(test)]
    pub(crate) fn click(&mut self, position: Pos2, mut ui: impl FnMut(&mut egui::Ui)) -> PlatformOutput {
        let button = |pressed| Event::PointerButton {
            pos: position,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        };
        self.pass(vec![Event::PointerMoved(position)], &mut ui);
        self.pass(vec![button(true)], &mut ui);
        self.pass(vec![button(false)], &mut ui)
    }

    /// Renders the last pass to an image of `size_points` × `pixels_per_point` pixels, rounded to whole pixels.
    pub(crate) fn picture(&self) -> Image<Rgba8> {
        let size = (self.size_points * self.pixels_per_point).round();
        let background = self.context.global_style().visuals.panel_fill;
        self.painter.paint_shapes(&self.context, self.shapes.clone(), (size.x as u32, size.y as u32), background)
    }

    fn input(&self, events: Vec<Event>) -> RawInput {
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size_points)),
            max_texture_side: Some(LARGEST_TEXTURE_SIDE),
            time: Some(f64::from(self.pass_count) * STEP_SECONDS),
            predicted_dt: STEP_SECONDS as f32,
            events,
            ..RawInput::default()
        };
        input.viewports.entry(ViewportId::ROOT).or_default().native_pixels_per_point = Some(self.pixels_per_point);
        input
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_interface_gives_the_same_picture_of_the_requested_size() {
        let paint = || {
            let mut headless = Headless::new(Vec2::new(90.0, 33.0), 1.5, egui::Theme::Dark);
            for _ in 0..3 {
                headless.pass(Vec::new(), |ui| {
                    ui.label("deterministic");
                });
            }
            headless.picture()
        };
        let picture = paint();
        assert_eq!(picture.size(), (135, 50));
        assert_eq!(picture, paint());
        assert!(picture.pixels().iter().any(|pixel| *pixel != picture.at(0, 0)), "the label is visible");
    }

    #[test]
    fn time_advances_by_one_step_per_pass() {
        let mut headless = Headless::new(Vec2::splat(10.0), 1.0, egui::Theme::Light);
        let mut times = Vec::new();
        for _ in 0..3 {
            headless.pass(Vec::new(), |ui| times.push(ui.input(|input| input.time)));
        }
        assert_eq!(times, [0.0, STEP_SECONDS, 2.0 * STEP_SECONDS]);
    }

    #[test]
    fn a_click_reaches_the_widget_under_it() {
        let mut headless = Headless::new(Vec2::new(100.0, 40.0), 1.0, egui::Theme::Dark);
        let mut clicks = 0;
        let mut ui = |ui: &mut egui::Ui| {
            if ui.button("Press").clicked() {
                clicks += 1;
            }
        };
        headless.pass(Vec::new(), &mut ui);
        headless.click(Pos2::new(12.0, 10.0), &mut ui);
        headless.click(Pos2::new(90.0, 35.0), &mut ui);
        assert_eq!(clicks, 1);
    }
}
