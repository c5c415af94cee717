//! Pictures as textures of the GPU.

use std::sync::Arc;

use eframe::egui::{ColorImage, TextureHandle, TextureId, TextureOptions, Ui};

use crate::image::{Image, Rgba8};

/// GPU texture of a picture, uploaded when the picture changes.
#[derive(Default)]
pub(super) struct PictureTexture {
    texture: Option<TextureHandle>,
    uploaded: Option<Arc<Image<Rgba8>>>,
}

impl PictureTexture {
    /// Uploads a picture if it has changed, and returns its texture. The texture is filtered with the nearest texel
    /// when magnified and linearly when minified.
    pub(super) fn show(&mut self, ui: &Ui, picture: &Arc<Image<Rgba8>>) -> TextureId {
        let (width, height) = picture.size();
        let image = || ColorImage::from_rgba_premultiplied([width as usize, height as usize], picture.as_bytes());
        let minification = TextureOptions::LINEAR.minification;
        let options = TextureOptions { minification, ..TextureOptions::NEAREST };
        let same = self.uploaded.as_ref().is_some_and(|old| Arc::ptr_eq(old, picture));
        self.uploaded = Some(picture.clone());
        if let Some(texture) = &mut self.texture {
            if !same {
                texture.set(image(), options);
            }
            return texture.id();
        }
        self.texture.insert(ui.ctx().load_texture("picture", image(), options)).id()
    }
}
