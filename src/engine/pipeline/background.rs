//! Background: the colour of the pixels that no triangle covers.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Background colour: the initial colour of every pixel. It remains where no triangle is drawn, and shows through
/// blended fragments that have no opaque surface behind them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Background {
    /// Background colour of the scene.
    #[default]
    Scene,
    /// Custom colour, as sRGB codes.
    Color([u8; 3]),
}

/// Text form of [`Background::Scene`] in files and on the command line.
const SCENE: &str = "scene";

impl Background {
    /// Returns the colour as sRGB codes; `of_scene` is the scene's background colour.
    pub fn resolve(self, of_scene: [u8; 3]) -> [u8; 3] {
        match self {
            Self::Scene => of_scene,
            Self::Color(color) => color,
        }
    }
}

impl fmt::Display for Background {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene => f.write_str(SCENE),
            Self::Color([red, green, blue]) => write!(f, "#{red:02x}{green:02x}{blue:02x}"),
        }
    }
}

impl FromStr for Background {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == SCENE {
            return Ok(Self::Scene);
        }
        let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6);
        let number = digits.filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
        let number = number.and_then(|digits| u32::from_str_radix(digits, 16).ok());
        let [_, red, green, blue] =
            number.ok_or_else(|| format!("`{text}` is not one of `{SCENE}`, `#rrggbb`"))?.to_be_bytes();
        Ok(Self::Color([red, green, blue]))
    }
}

impl TryFrom<String> for Background {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Background> for String {
    fn from(background: Background) -> Self {
        background.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back_from_their_text_and_nothing_else_is_taken() {
        for background in [Background::Scene, Background::Color([0, 10, 255]), Background::Color([18, 52, 86])] {
            assert_eq!(background.to_string().parse(), Ok(background));
        }
        assert_eq!("#1E90fF".parse(), Ok(Background::Color([0x1e, 0x90, 0xff])));
        for text in ["", "#", "#12345", "#1234567", "1e90ff", "#+12345", "#12345g", "Scene", "#é1234"] {
            let complaint = text.parse::<Background>().unwrap_err();
            assert!(complaint.contains("`scene`, `#rrggbb`"), "{text}: {complaint}");
        }
    }

    #[test]
    fn only_a_colour_of_its_own_replaces_that_of_the_scene() {
        assert_eq!(Background::Scene.resolve([1, 2, 3]), [1, 2, 3]);
        assert_eq!(Background::Color([4, 5, 6]).resolve([1, 2, 3]), [4, 5, 6]);
    }
}
