//! Small pictures of the built-in scenes, drawn once by the pipeline in the background when they are first shown.

use std::sync::mpsc::{Receiver, channel};

use eframe::egui::{Color32, ColorImage, Rect, Sense, TextureHandle, TextureOptions, Ui, Vec2, pos2, vec2};

use super::theme::tokens;
use crate::chain::{Recipe, run};
use crate::image::{Image, Rgba8};
use crate::pipeline::viewport::Viewport;
use crate::scene::builtin::{self, Builtin};

/// Size of the pictures, in pixels. Twice the size of most thumbnails, for displays with two pixels per point.
const PICTURE: Viewport = Viewport { width: 192, height: 108 };

/// Size of a thumbnail in a gallery, in points.
pub(crate) const LARGE: Vec2 = vec2(96.0, 54.0);

/// Size of a thumbnail in a list, in points.
pub(crate) const SMALL: Vec2 = vec2(48.0, 27.0);

/// Pictures of the built-in scenes, in the order of [`builtin::ALL`].
#[derive(Default)]
pub(crate) struct Thumbnails {
    textures: Vec<Option<TextureHandle>>,
    /// Pictures from the background thread, each with the index of its scene; `None` until the first thumbnail is shown.
    pictures: Option<Receiver<(usize, Image<Rgba8>)>>,
    /// Whether thumbnails are drawn synchronously, as in screenshots and tests.
    is_synchronous: bool,
}

impl Thumbnails {
    /// Creates thumbnails that are drawn when they are first shown: synchronously, or in a background thread.
    pub(crate) fn new(is_synchronous: bool) -> Self {
        Self { is_synchronous, ..Self::default() }
    }

    /// Adds the thumbnail of a scene, `size` points large; an empty rectangle until it is drawn.
    pub(crate) fn show(&mut self, ui: &mut Ui, scene: usize, size: Vec2) {
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        self.paint(ui, scene, rect);
    }

    /// Paints the thumbnail of a scene into `rect`; only a background until it is drawn.
    pub(crate) fn paint(&mut self, ui: &Ui, scene: usize, rect: Rect) {
        ui.painter().rect_filled(rect, 0.0, tokens(ui).canvas);
        self.receive(ui, scene);
        if let Some(Some(texture)) = self.textures.get(scene) {
            let uv = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
            ui.painter().image(texture.id(), rect, uv, Color32::WHITE);
        }
    }

    /// Takes over the pictures that are drawn. Starts drawing when it is called for the first time.
    fn receive(&mut self, ui: &Ui, scene: usize) {
        self.textures.resize(builtin::ALL.len(), None);
        if self.is_synchronous {
            if self.textures[scene].is_none() {
                self.textures[scene] = Some(uploaded(ui, &picture(&builtin::ALL[scene])));
            }
            return;
        }
        let pictures = self.pictures.get_or_insert_with(|| {
            let (sender, receiver) = channel();
            let context = ui.ctx().clone();
            std::thread::spawn(move || {
                for (index, scene) in builtin::ALL.iter().enumerate() {
                    // The receiver is gone if the window is closed.
                    if sender.send((index, picture(scene))).is_err() {
                        return;
                    }
                    context.request_repaint();
                }
            });
            receiver
        });
        for (index, picture) in pictures.try_iter() {
            self.textures[index] = Some(uploaded(ui, &picture));
        }
    }
}

/// Draws a scene from its home view with the default settings, on one thread.
fn picture(scene: &Builtin) -> Image<Rgba8> {
    let scene = scene.build();
    run(&scene, &scene.home, &Recipe::default(), PICTURE, &mut ()).image().clone()
}

fn uploaded(ui: &Ui, picture: &Image<Rgba8>) -> TextureHandle {
    let size = [PICTURE.width as usize, PICTURE.height as usize];
    let image = ColorImage::from_rgba_premultiplied(size, picture.as_bytes());
    ui.ctx().load_texture("thumbnail", image, TextureOptions::LINEAR)
}
