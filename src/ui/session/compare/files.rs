//! Pictures from files that take part in a comparison, in place of pictures that are drawn.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use crate::image::file::ImageFileError;
use crate::image::picture::{Layer, Picture};
use crate::image::{Image, Rgba8};
use crate::inspect::measured::{PictureStatistics, measure_layer};
use crate::inspect::view::Range;
use crate::measure::metric::Metric;
use crate::measure::picture_error::{LayerPair, PictureErrors, PictureLayer};
use crate::measure::tone::Tone;
use crate::pipeline::settings::Choice as _;

/// Displayed part of a picture file.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct PictureLook {
    /// Name of the displayed and compared layer. `None`, or a name that the file lacks, means the first layer.
    pub(crate) layer: Option<String>,
    /// Values of data that are shown as black and as white; `None` means the smallest and the largest value.
    pub(crate) range: Option<Range>,
}

/// Picture file of a comparison, with its exact samples and as displayed.
#[derive(Clone, Debug, PartialEq)]
pub struct OpenedPicture {
    /// Path that was opened: that of the file, or of a sequence of which the file is a frame.
    pub(crate) path: PathBuf,
    /// Path of the file.
    pub(crate) file: PathBuf,
    /// Exact samples of all channels.
    pub(crate) picture: Arc<Picture>,
    /// Displayed layer as opaque sRGB codes, after tone mapping.
    pub(crate) shown: Arc<Image<Rgba8>>,
    look: PictureLook,
    tone: Tone,
    /// Statistics of the displayed layer, computed when they are first needed.
    statistics: Arc<OnceLock<PictureStatistics>>,
}

impl OpenedPicture {
    /// Reads a picture file that was opened as `path`, which differs from `file` if it is a frame of a sequence. `tone`
    /// converts linear light for display.
    pub(crate) fn read(path: &Path, file: &Path, tone: Tone) -> Result<Self, ImageFileError> {
        Ok(Self::of(path, file, Picture::read(file)?, tone))
    }

    /// Returns a picture that was drawn and has no file; `name` takes the place of its path.
    pub(crate) fn drawn(name: &Path, picture: &Image<Rgba8>) -> Self {
        Self::of(name, name, Picture::of_codes(picture), Tone::default())
    }

    fn of(path: &Path, file: &Path, picture: Picture, tone: Tone) -> Self {
        Self {
            path: path.to_owned(),
            file: file.to_owned(),
            shown: Arc::new(tone.displayed(&picture, &picture.layers()[0])),
            picture: Arc::new(picture),
            look: PictureLook::default(),
            tone,
            statistics: Arc::default(),
        }
    }

    /// Returns the picture as displayed with another look and tone.
    fn displayed(&self, look: PictureLook, tone: Tone) -> Self {
        let mut displayed = Self { look, tone, ..self.clone() };
        let range = displayed.look.range.map(|range| f64::from(range.low)..=f64::from(range.high));
        displayed.shown = Arc::new(tone.displayed_in(&self.picture, displayed.layer(), range));
        if displayed.layer() != self.layer() {
            displayed.statistics = Arc::default();
        }
        displayed
    }

    /// Measures the errors of the stored values in the displayed layer against those of another picture. Returns `None` if
    /// they cannot be compared.
    pub(super) fn errors_against(&self, other: &Self) -> Option<PictureErrors> {
        let [a, b] = [self, other].map(|of| PictureLayer { picture: &of.picture, layer: of.layer() });
        let pair = LayerPair::new(a, b, self.tone).ok()?;
        let is_of_values = |metric: &Metric| !metric.measures_displayed();
        Some(pair.measure(&Metric::ALL.iter().copied().filter(is_of_values).collect::<Vec<_>>()))
    }

    /// Returns the displayed layer and its range.
    pub(crate) fn look(&self) -> &PictureLook {
        &self.look
    }

    /// Returns the displayed layer.
    pub(crate) fn layer(&self) -> &Layer {
        let layers = self.picture.layers();
        let named = layers.iter().find(|layer| self.look.layer.as_ref() == Some(&layer.name));
        named.unwrap_or(&layers[0])
    }

    /// Returns the statistics and histograms of the stored values in the displayed layer.
    pub(crate) fn statistics(&self) -> &PictureStatistics {
        self.statistics.get_or_init(|| measure_layer(&self.picture, self.layer()))
    }

    /// Whether exposure and tone curve change the displayed picture.
    fn has_tone(&self) -> bool {
        self.layer().is_color && self.picture.is_float(self.layer())
    }

    /// Returns the name of the file without its folder.
    pub(crate) fn name(&self) -> String {
        crate::text::path(self.file.file_name().map_or(&self.file, Path::new))
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

/// Opened picture files, their exposure and tone curve, and their displayed layers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct OpenedPictures {
    opened: Vec<Arc<OpenedPicture>>,
    /// Exposure and tone curve of float pictures, for display and metrics.
    tone: Tone,
    /// Look of every opened path that has another one than the default.
    looks: BTreeMap<PathBuf, PictureLook>,
}

impl OpenedPictures {
    /// Returns the opened picture with this path.
    pub(crate) fn get(&self, path: &Path) -> Option<Arc<OpenedPicture>> {
        self.opened.iter().find(|opened| opened.path == path).cloned()
    }

    /// Adds a picture, or replaces the picture with the same path and keeps its look.
    pub(super) fn insert(&mut self, picture: Arc<OpenedPicture>) {
        self.opened.retain(|opened| opened.path != picture.path);
        let look = self.look_of(&picture.path);
        let is_current = picture.look == look && (picture.tone == self.tone || !picture.has_tone());
        self.opened.push(if is_current { picture } else { Arc::new(picture.displayed(look, self.tone)) });
    }

    /// Returns the look of the picture with this path, also before it is opened.
    pub(super) fn look_of(&self, path: &Path) -> PictureLook {
        self.looks.get(path).cloned().unwrap_or_default()
    }

    /// Returns the exposure and tone curve.
    pub(crate) fn tone(&self) -> Tone {
        self.tone
    }

    /// Sets the exposure and tone curve, and converts all pictures.
    pub(super) fn set_tone(&mut self, tone: Tone) {
        self.tone = tone;
        for opened in self.opened.iter_mut().filter(|opened| opened.has_tone()) {
            *opened = Arc::new(opened.displayed(opened.look.clone(), tone));
        }
    }

    /// Sets the displayed layer and range of a picture.
    pub(super) fn set_look(&mut self, path: &Path, look: PictureLook) {
        self.looks.insert(path.to_owned(), look);
        if let Some(opened) = self.get(path) {
            self.insert(opened);
        }
    }

    /// Whether exposure and tone curve change any of the pictures.
    pub(crate) fn have_tone(&self) -> bool {
        self.opened.iter().any(|opened| opened.has_tone())
    }

    /// Returns all opened pictures.
    pub(crate) fn all(&self) -> impl Iterator<Item = &Arc<OpenedPicture>> {
        self.opened.iter()
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
