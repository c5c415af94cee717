//! Decoding of OBJ and MTL files to text, and splitting of the text into lines.
//!
//! Neither format specifies an encoding. A byte-order mark selects UTF-8 or UTF-16. Text without one is decoded as
//! UTF-8 if it is valid UTF-8, otherwise as Latin-1, which older exporters write. Names in OBJ and MTL then agree even
//! if the two files are encoded differently. Files in other formats are recognised here by their first bytes, so that
//! the message can name the format.

use std::borrow::Cow;

use memchr::memchr2;

use crate::scene::SceneFormat;

/// Decoded text of a file, and whether padding was removed.
#[derive(Debug, PartialEq)]
pub(super) struct Decoded {
    /// Text without a byte-order mark or trailing NUL bytes; line endings as in the file.
    pub(super) text: String,
    /// Whether NUL bytes were removed from the end. They are left by a crash of the exporter or by padding to whole
    /// sectors.
    pub(super) padded: bool,
}

/// Decodes the text in `bytes`. If the file is not text, the error message names its actual type.
pub(super) fn decode(mut bytes: Vec<u8>) -> Result<Decoded, String> {
    if let [0xFE, 0xFF, rest @ ..] = bytes.as_slice() {
        return Ok(Decoded { text: from_utf16(rest, u16::from_be_bytes), padded: false });
    }
    if let [0xFF, 0xFE, rest @ ..] = bytes.as_slice() {
        return Ok(Decoded { text: from_utf16(rest, u16::from_le_bytes), padded: false });
    }
    if let Some(other) = foreign_format(&bytes) {
        return Err(other);
    }
    if bytes.starts_with(b"\xEF\xBB\xBF") {
        bytes.drain(..3);
    }
    let length = bytes.iter().rposition(|b| !matches!(*b, 0 | DOS_END)).map_or(0, |last| last + 1);
    let padded = bytes[length..].contains(&0);
    bytes.truncate(length);
    if bytes.iter().any(|b| is_binary(*b)) {
        return Err("this is binary data, not text".to_owned());
    }
    let text =
        String::from_utf8(bytes).unwrap_or_else(|not_utf8| not_utf8.into_bytes().into_iter().map(char::from).collect());
    Ok(Decoded { text, padded })
}

fn from_utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

/// End-of-file character of DOS text files.
const DOS_END: u8 = 0x1A;

/// Whether a byte is a control character that never occurs in text. Tab, line endings, vertical tab and form feed are
/// allowed.
fn is_binary(byte: u8) -> bool {
    byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0B | 0x0C)
}

/// Recognises a file of another format by its first bytes. Returns a message that names the format; `None` if the file
/// may be OBJ or MTL text.
pub(in crate::scene) fn foreign_format(bytes: &[u8]) -> Option<String> {
    const KNOWN: [(&[u8], &str); 14] = [
        (b"\x89PNG", "this is a PNG image"),
        (b"\xFF\xD8\xFF", "this is a JPEG image"),
        (b"GIF8", "this is a GIF image"),
        (b"PK\x03\x04", "this is a ZIP archive; unpack it first"),
        (b"\x1F\x8B", "this is gzip-compressed; unpack it first"),
        (b"glTF", "this is a binary glTF model"),
        (b"Kaydara FBX", "this is an FBX model; export it as {formats}"),
        (b"BLENDER", "this is a Blender file; export it as {formats}"),
        (b"ply", "this is a PLY model; export it as {formats}"),
        (b"solid ", "this is an STL model; export it as {formats}"),
        (b"OFF", "this is an OFF model; export it as {formats}"),
        (b"version https://git-lfs", "this is a Git LFS pointer, not the model itself; fetch it with `git lfs pull`"),
        (b"<", "this is a web page or XML, not a model; the download may have failed"),
        (b"{", "this is JSON"),
    ];
    let start = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes).trim_ascii_start();
    let (_, what) = KNOWN.iter().find(|(signature, _)| start.starts_with(signature))?;
    Some(what.replace("{formats}", &SceneFormat::names()))
}

/// Iterator over the lines of a text with their numbers from 1. Lines end with LF, CR LF or CR; a form feed does not
/// end a line.
pub(super) struct Lines<'a> {
    rest: &'a str,
    number: usize,
    length: usize,
}

/// Returns the lines of `text`.
pub(super) fn lines(text: &str) -> Lines<'_> {
    Lines { rest: text, number: 0, length: text.len() }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let end = memchr2(b'\n', b'\r', self.rest.as_bytes()).unwrap_or(self.rest.len());
        let (line, tail) = self.rest.split_at(end);
        self.rest = tail.strip_prefix("\r\n").or_else(|| tail.get(1..)).unwrap_or("");
        self.number += 1;
        Some((self.number, line))
    }
}

/// Iterator like [`Lines`], except that a line that ends with a backslash is joined with the next line. Joined lines
/// have the number of the first one. Comments are not joined, because they may end with a path.
pub(super) struct JoinedLines<'a>(Lines<'a>);

/// Returns the lines of `text`, with continued lines joined.
pub(super) fn joined_lines(text: &str) -> JoinedLines<'_> {
    JoinedLines(lines(text))
}

impl JoinedLines<'_> {
    /// Returns the completed fraction of the text, from 0 to 1.
    pub(super) fn completed(&self) -> f32 {
        1.0 - self.0.rest.len() as f32 / self.0.length.max(1) as f32
    }
}

impl<'a> Iterator for JoinedLines<'a> {
    type Item = (usize, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let (number, first) = self.0.next()?;
        let mut joined = Cow::Borrowed(first);
        let is_comment = first.trim_start().starts_with('#');
        while let Some(kept) = joined.trim_end().strip_suffix('\\').map(str::len).filter(|_| !is_comment) {
            let next = self.0.next().map_or("", |(_, line)| line);
            let joined = joined.to_mut();
            joined.truncate(kept);
            joined.push(' ');
            joined.push_str(next);
        }
        Some((number, joined))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> String {
        decode(bytes.to_vec()).unwrap().text
    }

    #[test]
    fn every_encoding_gives_the_same_text() {
        let utf16 = |unit: fn(u16) -> [u8; 2]| "\u{feff}o Straße".encode_utf16().flat_map(unit).collect::<Vec<u8>>();
        for bytes in [
            "o Straße".as_bytes().to_vec(),
            "\u{feff}o Straße".as_bytes().to_vec(),
            b"o Stra\xDFe".to_vec(),
            utf16(u16::to_le_bytes),
            utf16(u16::to_be_bytes),
        ] {
            assert_eq!(text(&bytes), "o Straße");
        }
    }

    #[test]
    fn trailing_nul_bytes_are_removed_and_others_mean_binary_data() {
        assert_eq!(decode(b"v 0\n\0\0".to_vec()), Ok(Decoded { text: "v 0\n".to_owned(), padded: true }));
        assert!(decode(b"v\0 0\n".to_vec()).unwrap_err().contains("binary"));
    }

    #[test]
    fn line_endings_of_all_systems_are_recognised() {
        let expected = vec![(1, "a"), (2, ""), (3, "b")];
        for text in ["a\n\nb", "a\r\n\r\nb\r\n", "a\r\rb\r"] {
            assert_eq!(lines(text).collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn continued_lines_keep_the_number_of_the_first() {
        let joined: Vec<_> = joined_lines("f 1 \\\r\n2 \\\n3\n# C:\\\nv\nf \\").collect();
        let expected = [(1, "f 1  2  3"), (4, "# C:\\"), (5, "v"), (6, "f  ")];
        assert_eq!(joined.iter().map(|(n, l)| (*n, l.as_ref())).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn foreign_files_are_recognised() {
        for (bytes, word) in [
            (b"\x89PNG\r\n\x1a\n".as_slice(), "PNG"),
            (b"\n <!DOCTYPE html>", "web page"),
            (b"version https://git-lfs.github.com/spec/v1", "git lfs pull"),
            (b"solid cube\n facet normal 0 0 1", "STL"),
            (b"\x01\x02\x03", "binary"),
        ] {
            assert!(decode(bytes.to_vec()).unwrap_err().contains(word));
        }
    }
}
