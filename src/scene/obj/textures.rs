//! Pictures that materials name: found, read once each, and kept within a budget.
//!
//! A picture may lie outside the model's folder (`../textures/x.png` is common), as nothing of it is shown but its
//! pixels. A path of the exporter's machine (`C:\work\x.png`) is taken as the file of that name beside the library.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::mtl::Picture;
use super::warnings::Warnings;
use crate::image::file;
use crate::scene::{Library, Texture, TextureId};

/// Most bytes that the textures of one model may take as codes, 4 for each texel. Drawing keeps copies besides: of another 4
/// bytes for each texel where light is computed in codes, of 16 in linear light; with mip maps of some 7 and 25.
const BUDGET_BYTES: usize = 512 << 20;

/// The textures of one model.
#[derive(Default)]
pub(super) struct Textures {
    /// What became of each file.
    known: HashMap<PathBuf, Option<TextureId>>,
    bytes: usize,
}

impl Textures {
    /// The texture of a picture, read now or before. `None` with a warning where it cannot be read.
    pub(super) fn get(
        &mut self,
        picture: &Picture,
        model: &Path,
        library: &mut Library,
        warnings: &mut Warnings,
    ) -> Option<TextureId> {
        let path = locate(picture, model);
        let same_file = path.canonicalize().unwrap_or_else(|_| path.clone());
        if let Some(known) = self.known.get(&same_file) {
            return *known;
        }
        let texture = match self.read(&path) {
            Ok(texture) => Some(library.add_texture(texture)),
            Err(reason) => {
                let text = format!("texture left out, the plain colour is used: {reason}");
                warnings.add(&picture.library, Some(picture.line), text);
                None
            }
        };
        self.known.insert(same_file, texture);
        texture
    }

    fn read(&mut self, path: &Path) -> Result<Texture, String> {
        let image = file::read(path).map_err(|e| e.to_string())?;
        if self.bytes + image.bytes() > BUDGET_BYTES {
            return Err(format!("{}: more than {} MiB of textures", path.display(), BUDGET_BYTES >> 20));
        }
        self.bytes += image.bytes();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Texture::new(name, image).ok_or_else(|| format!("{}: it has no pixels", path.display()))
    }
}

/// The first place where the picture is; if it is nowhere, the first place where it could be.
fn locate(picture: &Picture, model: &Path) -> PathBuf {
    let folder = |file: &Path| file.parent().map_or_else(PathBuf::new, Path::to_owned);
    let (beside_library, beside_model) = (folder(&picture.library), folder(model));
    let written = Path::new(&picture.name);
    let is_foreign = written.is_absolute() || picture.name.chars().nth(1) == Some(':');
    let bare = beside_library.join(written.file_name().unwrap_or_default());
    let candidates =
        if is_foreign { vec![bare] } else { vec![beside_library.join(written), beside_model.join(written), bare] };
    candidates.iter().find(|path| path.exists()).unwrap_or(&candidates[0]).clone()
}
