//! A layer of the overlay stack, and its text form.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::{Overlay, OverlayContext, Sheet, normals};
use crate::inspect::normals::DEFAULT_LENGTH;
use crate::pipeline::settings::Choice as _;

/// An overlay in the stack, with its settings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct OverlayLayer {
    /// Overlay that the layer shows.
    pub overlay: Overlay,
    /// Opacity of the layer, in [0, 1].
    pub opacity: f32,
    /// Length of normals, in [0, 1], as a fraction of the diagonal of the scene's bounding box; unused by other
    /// overlays.
    pub length: f32,
}

impl From<Overlay> for OverlayLayer {
    /// Creates a layer with the default opacity and length.
    fn from(overlay: Overlay) -> Self {
        Self { overlay, opacity: overlay.first_opacity(), length: DEFAULT_LENGTH }
    }
}

impl OverlayLayer {
    /// Returns the command-line form: `facing`, or `facing=0.4` if the opacity is not the default. A non-default length
    /// of normals follows, as in `face-normals=1,length=0.1`.
    pub fn text(&self) -> String {
        let (id, opacity) = (self.overlay.id(), self.opacity);
        match self.drawn_length().filter(|length| *length != DEFAULT_LENGTH) {
            Some(length) => format!("{id}={opacity},length={length}"),
            None if opacity == self.overlay.first_opacity() => id.to_owned(),
            None => format!("{id}={opacity}"),
        }
    }

    /// Returns the length of normals as a fraction of the diagonal of the scene's bounding box; `None` for other
    /// overlays.
    fn drawn_length(&self) -> Option<f32> {
        self.overlay.has_length().then_some(self.length)
    }

    /// Whether a sheet shows the overlay of this layer with the layer's current length.
    pub fn is_of(&self, sheet: &Sheet) -> bool {
        sheet.overlay == self.overlay && sheet.length == self.drawn_length()
    }

    /// Computes the sheet of the layer's overlay for a frame.
    pub fn sheet(&self, context: &OverlayContext<'_>) -> Sheet {
        match self.drawn_length() {
            Some(length) => normals::normals(self.overlay, length, context),
            None => self.overlay.sheet(context),
        }
    }
}

impl FromStr for OverlayLayer {
    type Err = String;

    /// Parses the output of [`OverlayLayer::text`].
    fn from_str(text: &str) -> Result<Self, String> {
        let (id, opacity) = text.split_once('=').map_or((text, None), |(id, opacity)| (id, Some(opacity)));
        let known = || Overlay::ALL.iter().map(|overlay| overlay.id()).collect::<Vec<_>>().join(", ");
        let overlay = Overlay::ALL.iter().copied().find(|overlay| overlay.id() == id);
        let layer = Self::from(overlay.ok_or_else(|| format!("`{id}` is not an overlay; use one of {}", known()))?);
        let Some(opacity) = opacity else { return Ok(layer) };
        let share = |text: &str, what: &str| {
            let number = text.parse().ok().filter(|number| (0.0..=1.0).contains(number));
            number.ok_or_else(|| format!("`{text}` is not a valid {what}; use a number from 0 to 1"))
        };
        let (opacity, length) = opacity.split_once(",length=").map_or((opacity, None), |(o, length)| (o, Some(length)));
        if length.is_some() && !layer.overlay.has_length() {
            return Err(format!("`{id}` has no length; only overlays of normals have one"));
        }
        let length = length.map_or(Ok(layer.length), |length| share(length, "length"))?;
        Ok(Self { opacity: share(opacity, "opacity")?, length, ..layer })
    }
}

impl From<OverlayLayer> for String {
    fn from(layer: OverlayLayer) -> Self {
        layer.text()
    }
}

impl TryFrom<String> for OverlayLayer {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_survive_a_round_trip_through_text() {
        for overlay in Overlay::ALL {
            for opacity in [overlay.first_opacity(), 0.0, 1.0 / 3.0, 1.0] {
                for length in [DEFAULT_LENGTH, 0.25] {
                    let length = if overlay.has_length() { length } else { DEFAULT_LENGTH };
                    let layer = OverlayLayer { overlay: *overlay, opacity, length };
                    assert_eq!(layer.text().parse(), Ok(layer), "{}", layer.text());
                }
            }
            assert_eq!(overlay.id().parse(), Ok(OverlayLayer::from(*overlay)));
        }
        for (text, reported) in [
            ("fog", "facing"),
            ("facing=2", "from 0 to 1"),
            ("facing=", "from 0 to 1"),
            ("facing=1,length=0.1", "has no length"),
        ] {
            assert!(text.parse::<OverlayLayer>().unwrap_err().contains(reported), "{text}");
        }
    }
}
