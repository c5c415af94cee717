//! Description of an upscaler process, as on the command line: `ID[:OPTION,…]=COMMAND`.

use std::str::FromStr;

use crate::text;
use crate::upscale::Scale;

/// Format of the colours that are exchanged with a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PixelFormat {
    /// Four bytes per pixel: sRGB codes and alpha.
    Rgba8,
    /// Four 32-bit floats per pixel: sRGB codes and alpha, divided by 255.
    RgbaF32,
}

impl PixelFormat {
    /// Returns the number of bytes of one pixel.
    pub(super) fn pixel_bytes(self) -> usize {
        match self {
            Self::Rgba8 => 4,
            Self::RgbaF32 => 16,
        }
    }
}

/// Upscaler that runs as an external process: its id, its options and its command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProcessSpec {
    /// Description from which the other fields were parsed.
    pub(super) text: String,
    /// Id of the upscaler.
    pub(super) id: String,
    /// Offered scales, in ascending order.
    pub(super) scales: Vec<Scale>,
    pub(super) format: PixelFormat,
    /// Whether the process reads the depths of the samples.
    pub(super) depth: bool,
    /// Path of the program, and its arguments.
    pub(super) command: Vec<String>,
}

impl ProcessSpec {
    /// Returns the id of the upscaler.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Returns the command as clean text, for messages.
    pub(super) fn command_text(&self) -> String {
        text::one_line(&self.command.join(" "))
    }
}

impl FromStr for ProcessSpec {
    type Err = String;

    /// Parses `ID[:OPTION,…]=COMMAND`. Options are scales, `f32` and `depth`; without a scale, the scale is 2. The
    /// command is split at spaces outside quotes and is not interpreted by a shell.
    fn from_str(text: &str) -> Result<Self, String> {
        let (head, command) =
            text.split_once('=').ok_or("expected ID=COMMAND or ID:SCALE,…=COMMAND, such as my-net:2=python3 net.py")?;
        let (id, options) = head.split_once(':').unwrap_or((head, ""));
        let command = words(command)?;
        if command.is_empty() {
            return Err("the command after `=` is empty".to_owned());
        }
        let (text, id, format) = (text.to_owned(), id.to_owned(), PixelFormat::Rgba8);
        let mut spec = Self { text, id, scales: Vec::new(), format, depth: false, command };
        for option in options.split(',').map(str::trim).filter(|option| !option.is_empty()) {
            match option {
                "f32" => spec.format = PixelFormat::RgbaF32,
                "depth" => spec.depth = true,
                _ => spec.scales.push(scale(option)?),
            }
        }
        if spec.scales.is_empty() {
            spec.scales.push(Scale::TWO);
        }
        spec.scales.sort_unstable();
        spec.scales.dedup();
        Ok(spec)
    }
}

/// Parses an upscaling factor above 1.
fn scale(option: &str) -> Result<Scale, String> {
    let factor = option.parse::<f64>().ok().filter(|factor| *factor > 1.0);
    factor.filter(|factor| Scale::from(*factor).value() == *factor).map(Scale::from).ok_or_else(|| {
        format!("`{option}` is neither a scale (a multiple of 0.1 above 1 and up to 4) nor `f32` nor `depth`")
    })
}

/// Splits a command at white space outside single and double quotes, and removes the quotes.
fn words(command: &str) -> Result<Vec<String>, String> {
    let mut words: Vec<String> = Vec::new();
    let (mut quote, mut in_word) = (None, false);
    for c in command.chars() {
        if quote == Some(c) {
            quote = None;
            continue;
        }
        let is_quote = quote.is_none() && (c == '"' || c == '\'');
        if quote.is_none() && c.is_whitespace() {
            in_word = false;
            continue;
        }
        if !in_word {
            in_word = true;
            words.push(String::new());
        }
        if is_quote {
            quote = Some(c);
        } else if let Some(word) = words.last_mut() {
            word.push(c);
        }
    }
    if quote.is_some() { Err("a quote in the command is not closed".to_owned()) } else { Ok(words) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_and_quoted_commands_are_parsed() {
        let spec: ProcessSpec = "my-net:4,2,f32,depth=python3 'my net.py' --x=\"a b\" ''".parse().unwrap();
        assert_eq!((spec.id.as_str(), spec.depth, spec.format), ("my-net", true, PixelFormat::RgbaF32));
        assert_eq!(spec.scales, [Scale::TWO, Scale::FOUR]);
        assert_eq!(spec.command, ["python3", "my net.py", "--x=a b", ""]);
        let plain: ProcessSpec = "a=b".parse().unwrap();
        assert_eq!((plain.scales, plain.format, plain.depth), (vec![Scale::TWO], PixelFormat::Rgba8, false));
    }

    #[test]
    fn invalid_descriptions_are_explained() {
        for (text, reason) in [
            ("python3 net.py", "expected ID=COMMAND"),
            ("a=", "is empty"),
            ("a:5=b", "`5` is neither a scale"),
            ("a:1=b", "`1` is neither a scale"),
            ("a:2.25=b", "`2.25` is neither a scale"),
            ("a:f16=b", "`f16` is neither a scale"),
            ("a=b 'c", "not closed"),
        ] {
            let error = text.parse::<ProcessSpec>().unwrap_err();
            assert!(error.contains(reason), "{text}: {error}");
        }
    }
}
