//! An overlay of a stack, and how strong it is.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::Overlay;
use crate::pipeline::settings::Choice as _;

/// An overlay of the stack.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Layer {
    /// Which.
    pub overlay: Overlay,
    /// How strong, in [0, 1].
    pub opacity: f32,
}

impl From<Overlay> for Layer {
    /// As strong as it is at first.
    fn from(overlay: Overlay) -> Self {
        Self { overlay, opacity: overlay.first_opacity() }
    }
}

impl Layer {
    /// As a word of the command line: `facing`, or `facing=0.4` if it is not as strong as at first.
    pub fn text(&self) -> String {
        let id = self.overlay.id();
        if self.opacity == self.overlay.first_opacity() { id.to_owned() } else { format!("{id}={}", self.opacity) }
    }
}

impl FromStr for Layer {
    type Err = String;

    /// Reads what [`Layer::text`] writes.
    fn from_str(text: &str) -> Result<Self, String> {
        let (id, opacity) = text.split_once('=').map_or((text, None), |(id, opacity)| (id, Some(opacity)));
        let known = || Overlay::ALL.iter().map(|overlay| overlay.id()).collect::<Vec<_>>().join(", ");
        let overlay = Overlay::ALL.iter().copied().find(|overlay| overlay.id() == id);
        let layer = Self::from(overlay.ok_or_else(|| format!("`{id}` is no overlay; there are {}", known()))?);
        let Some(opacity) = opacity else { return Ok(layer) };
        let number = opacity.parse().ok().filter(|opacity| (0.0..=1.0).contains(opacity));
        let opacity = number.ok_or_else(|| format!("`{opacity}` is no opacity: a number from 0 to 1"))?;
        Ok(Self { opacity, ..layer })
    }
}

impl From<Layer> for String {
    fn from(layer: Layer) -> Self {
        layer.text()
    }
}

impl TryFrom<String> for Layer {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_read_as_they_are_written() {
        for overlay in Overlay::ALL {
            for opacity in [overlay.first_opacity(), 0.0, 1.0 / 3.0, 1.0] {
                let layer = Layer { overlay: *overlay, opacity };
                assert_eq!(layer.text().parse(), Ok(layer), "{}", layer.text());
            }
            assert_eq!(overlay.id().parse(), Ok(Layer::from(*overlay)));
        }
        for (text, told) in [("fog", "facing"), ("facing=2", "from 0 to 1"), ("facing=", "from 0 to 1")] {
            assert!(text.parse::<Layer>().unwrap_err().contains(told), "{text}");
        }
    }
}
