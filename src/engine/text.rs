//! Sanitising of text from outside the program: names in models, file names, and messages from decoders and from the
//! operating system.
//!
//! A terminal interprets control characters, and bidirectional controls make a name look like another one. [`clean`]
//! replaces both; scene loaders apply it to every name, so the rest of the program can print names as they are.

use std::borrow::Cow;
use std::path::Path;

/// Maximum length of a message from a decoder or from the operating system, in characters.
const MAX_MESSAGE_CHARS: usize = 200;

/// Returns `text` with control characters, line separators and bidirectional controls replaced by U+FFFD.
pub fn clean(text: &str) -> Cow<'_, str> {
    if text.contains(is_unsafe) {
        Cow::Owned(text.chars().map(|c| if is_unsafe(c) { char::REPLACEMENT_CHARACTER } else { c }).collect())
    } else {
        Cow::Borrowed(text)
    }
}

/// Returns `text` as one clean line: runs of white space and line ends become single spaces.
pub fn one_line(text: &str) -> String {
    let words: Vec<_> = text.split_whitespace().map(clean).collect();
    words.join(" ")
}

/// Returns a message from a library or the operating system as one clean line of at most 200 characters.
pub(crate) fn message(text: &str) -> String {
    let line = one_line(text);
    match line.char_indices().nth(MAX_MESSAGE_CHARS - 1) {
        Some((end, last)) if end + last.len_utf8() < line.len() => format!("{}…", &line[..end]),
        _ => line,
    }
}

/// Returns a path as clean text on one line, for display.
pub fn path(path: &Path) -> String {
    one_line(&path.display().to_string())
}

/// Returns the words of a command as one line for a POSIX shell, each quoted if necessary.
pub fn shell_line<W: AsRef<str>>(words: &[W]) -> String {
    words.iter().map(|word| quoted(word.as_ref())).collect::<Vec<_>>().join(" ")
}

/// Quotes a word for a POSIX shell if necessary.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// Returns whether a terminal or a title bar may interpret the character instead of displaying it: C0 controls, DEL, C1
/// controls, bidirectional controls, and line and paragraph separators.
fn is_unsafe(c: char) -> bool {
    let is_bidi = matches!(c, '\u{61C}' | '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}');
    c.is_control() || is_bidi || matches!(c, '\u{2028}' | '\u{2029}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_that_a_terminal_obeys_are_replaced() {
        let controls = (0..0x20).chain(0x7F..0xA0).chain([0x61C, 0x200E, 0x200F, 0x2028, 0x2029]);
        let controls = controls.chain(0x202A..=0x202E).chain(0x2066..=0x2069).filter_map(char::from_u32);
        for control in controls {
            assert_eq!(clean(&format!("a{control}b")), "a\u{FFFD}b", "{control:?}");
        }
        for name in ["Stuhl über Eck", "椅子", "كرسي", "👩‍🔬", "a b"] {
            assert!(matches!(clean(name), Cow::Borrowed(same) if same == name), "{name}");
        }
    }

    #[test]
    fn messages_are_one_line_of_at_most_200_characters() {
        assert_eq!(message("a\n  b\t\x1b]0;title\x07 c"), "a b \u{FFFD}]0;title\u{FFFD} c");
        let (fits, long) = ("ä".repeat(200), "ä".repeat(201));
        assert_eq!(message(&fits), fits);
        assert_eq!(message(&long), format!("{}…", "ä".repeat(199)));
    }

    #[test]
    fn words_are_quoted_only_if_a_shell_requires_it() {
        assert_eq!(quoted("fill_rule=top-left"), "fill_rule=top-left");
        assert_eq!(quoted("my model.obj"), "'my model.obj'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }
}
