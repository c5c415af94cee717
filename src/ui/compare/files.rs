//! Pictures from files that take part in a comparison, in place of pictures that are drawn.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::image::file::ImageFileError;
use crate::image::picture::Picture;
use crate::image::{Image, Rgba8};
use crate::measure::tone::Tone;

/// Part of a picture in a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureRole {
    /// Picture of the tile with this index; tile 0 is A, tile 1 is B.
    Tile(usize),
    /// Reference that errors are measured against.
    Reference,
}

impl PictureRole {
    /// Roles with menu entries: A, B and the reference.
    pub(crate) const LISTED: [Self; 3] = [Self::Tile(0), Self::Tile(1), Self::Reference];

    /// Returns the display name, such as `A` or `reference`.
    pub(crate) fn name(self) -> String {
        match self {
            Self::Tile(tile) => super::letter(tile).to_string(),
            Self::Reference => "reference".to_owned(),
        }
    }
}

/// Picture file of a comparison, with its exact samples and as displayed.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenedPicture {
    /// Path of the file.
    pub(crate) path: PathBuf,
    /// Exact samples of all channels.
    pub(crate) picture: Arc<Picture>,
    /// First layer as opaque sRGB codes, after tone mapping.
    pub(crate) shown: Arc<Image<Rgba8>>,
}

impl OpenedPicture {
    /// Reads a picture file. `tone` converts linear light for display.
    pub(crate) fn read(path: &Path, tone: Tone) -> Result<Self, ImageFileError> {
        let picture = Arc::new(Picture::read(path)?);
        let shown = Arc::new(tone.displayed(&picture, &picture.layers()[0]));
        Ok(Self { path: path.to_owned(), picture, shown })
    }

    /// Returns a picture that was drawn and has no file; `name` takes the place of its path.
    pub(crate) fn drawn(name: PathBuf, picture: &Image<Rgba8>) -> Self {
        Self { path: name, picture: Arc::new(Picture::of_codes(picture)), shown: Arc::new(picture.clone()) }
    }

    /// Returns the picture as displayed with another tone.
    fn toned(&self, tone: Tone) -> Self {
        let shown = Arc::new(tone.displayed(&self.picture, &self.picture.layers()[0]));
        Self { shown, ..self.clone() }
    }

    /// Whether exposure and tone curve change the displayed picture.
    fn has_tone(&self) -> bool {
        let layer = &self.picture.layers()[0];
        layer.is_color && self.picture.is_float(layer)
    }

    /// Returns the name of the file without its folder.
    pub(crate) fn name(&self) -> String {
        crate::text::path(self.path.file_name().map_or(&self.path, Path::new))
    }

    /// Returns the stored value of every channel at a pixel, such as `R 0.5  G 1  B 0.25`, layer by layer.
    pub(crate) fn values_at(&self, (x, y): (u32, u32)) -> String {
        let value = |channel: &crate::image::picture::Channel| match channel.sample(x, y) {
            Some(sample) => format!("{} {sample}", channel.name),
            None => format!("{} –", channel.name),
        };
        let channels = self.picture.layers().iter().flat_map(|layer| self.picture.channels_of(layer));
        channels.map(value).collect::<Vec<_>>().join("  ")
    }
}

/// Opened picture files, and their exposure and tone curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct OpenedPictures {
    opened: Vec<Arc<OpenedPicture>>,
    /// Exposure and tone curve of float pictures, for display and metrics.
    tone: Tone,
}

impl OpenedPictures {
    /// Returns the opened picture with this path.
    pub(crate) fn get(&self, path: &Path) -> Option<Arc<OpenedPicture>> {
        self.opened.iter().find(|opened| opened.path == path).cloned()
    }

    /// Adds a picture, or replaces the picture with the same path.
    pub(super) fn insert(&mut self, picture: Arc<OpenedPicture>) {
        self.opened.retain(|opened| opened.path != picture.path);
        self.opened.push(picture);
    }

    /// Returns the exposure and tone curve.
    pub(crate) fn tone(&self) -> Tone {
        self.tone
    }

    /// Sets the exposure and tone curve, and converts all pictures.
    pub(super) fn set_tone(&mut self, tone: Tone) {
        self.tone = tone;
        for opened in self.opened.iter_mut().filter(|opened| opened.has_tone()) {
            *opened = Arc::new(opened.toned(tone));
        }
    }

    /// Whether exposure and tone curve change any of the pictures.
    pub(crate) fn have_tone(&self) -> bool {
        self.opened.iter().any(|opened| opened.has_tone())
    }

    /// Returns the paths of all opened files.
    pub(crate) fn paths(&self) -> impl Iterator<Item = &Path> {
        self.opened.iter().map(|opened| opened.path.as_path())
    }
}

/// Picture files of a comparison request.
#[derive(Clone, Debug, Default)]
pub struct ComparedFiles {
    /// Picture file of each tile; `None`, or a missing entry, if the tile is drawn.
    pub(crate) tiles: Vec<Option<Arc<OpenedPicture>>>,
    /// Reference from a file; `None` if the reference is drawn.
    pub(crate) reference: Option<Arc<OpenedPicture>>,
}

impl ComparedFiles {
    /// Returns the picture file of a tile; `None` if the tile is drawn.
    pub(crate) fn of_tile(&self, tile: usize) -> Option<&Arc<OpenedPicture>> {
        self.tiles.get(tile)?.as_ref()
    }

    /// Whether both have the same pictures in all tiles.
    pub(super) fn has_same_tiles(&self, other: &Self) -> bool {
        let count = self.tiles.len().max(other.tiles.len());
        (0..count).all(|tile| is_same(self.of_tile(tile), other.of_tile(tile)))
    }

    /// Whether both have the same reference.
    pub(super) fn has_same_reference(&self, other: &Self) -> bool {
        is_same(self.reference.as_ref(), other.reference.as_ref())
    }
}

/// Returns whether both are the same displayed picture, or both are drawn.
pub(super) fn is_same(a: Option<&Arc<OpenedPicture>>, b: Option<&Arc<OpenedPicture>>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => Arc::ptr_eq(&a.shown, &b.shown),
        (a, b) => a.is_none() && b.is_none(),
    }
}
