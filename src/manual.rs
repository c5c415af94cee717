//! Built-in manual: the pages of `assets/manual`, and a search over them.

use std::borrow::Cow;

/// Declares the enum of chapters. Each entry consists of a variant and a file name; the entries are in reading order.
macro_rules! chapters {
    ($($(#[$attribute:meta])* $chapter:ident = $file:literal,)+) => {
        /// Chapter of the manual.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub enum Chapter {
            $($(#[$attribute])* #[doc = concat!("`assets/manual/", $file, "`.")] $chapter,)+
        }

        impl Chapter {
            /// All chapters, in reading order.
            pub const ALL: &[Self] = &[$(Self::$chapter),+];

            /// Returns the file name of the chapter in `assets/manual`.
            pub fn file(self) -> &'static str {
                match self {
                    $(Self::$chapter => $file,)+
                }
            }

            /// Returns the text of the chapter, in Markdown.
            pub fn text(self) -> &'static str {
                match self {
                    $(Self::$chapter => include_str!(concat!("../assets/manual/", $file)),)+
                }
            }
        }
    };
}

chapters! {
    #[default]
    GettingStarted = "01-getting-started.md",
    InspectingAPixel = "02-inspecting-a-pixel.md",
    Stages = "03-stages.md",
    ComparingUpscalers = "04-comparing-upscalers.md",
    ErrorAgainstTime = "05-error-against-time.md",
    Stability = "06-stability.md",
    SkippedWork = "07-skipped-work.md",
    Lab = "08-2d-lab.md",
    Settings = "09-settings.md",
    Commands = "10-commands.md",
    CaseFiles = "11-case-files.md",
    ScenesAndFileFormats = "12-scenes-and-file-formats.md",
    Conventions = "13-conventions.md",
    ReadingPlots = "14-reading-plots.md",
    Reference = "15-reference.md",
    OtherRenderers = "16-other-renderers.md",
    Changelog = "17-changelog.md",
}

/// Section of a chapter: a first-level or second-level heading, with the text up to the next such heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Section {
    /// Text of the heading, without its leading `#` marks.
    pub(crate) heading: &'static str,
    /// Heading and text in Markdown, without images and comments.
    pub(crate) markdown: String,
}

/// Search result: a section that contains all words of the search.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Passage {
    /// Chapter that contains the section.
    pub chapter: Chapter,
    /// Index of the section in [`Chapter::sections`].
    pub(crate) section: usize,
    /// Heading of the section.
    pub heading: &'static str,
    /// First line below the heading that contains one of the words, without Markdown marks; empty if there is none.
    pub(crate) line: String,
}

impl Chapter {
    /// Returns the title: the text of the first heading.
    pub fn title(self) -> &'static str {
        self.text().lines().find_map(|line| line.strip_prefix("# ")).unwrap_or(self.file())
    }

    /// Returns the chapter that a link in this chapter points to, and the index of the section in
    /// [`Chapter::sections`]. Returns `None` if the link leads outside the manual or to an unknown heading.
    pub(crate) fn linked_section(self, link: &str) -> Option<(Self, usize)> {
        let (file, wanted) = link.split_once('#').unwrap_or((link, ""));
        let chapter =
            if file.is_empty() { self } else { Self::ALL.iter().copied().find(|chapter| chapter.file() == file)? };
        if wanted.is_empty() {
            return Some((chapter, 0));
        }
        let has_heading =
            |section: &Section| section.markdown.lines().any(|line| line.starts_with('#') && anchor(line) == wanted);
        Some((chapter, chapter.sections().iter().position(has_heading)?))
    }

    /// Returns the sections in reading order. Images are omitted, because they show the window that the reader is
    /// looking at.
    pub(crate) fn sections(self) -> Vec<Section> {
        let mut sections: Vec<Section> = Vec::new();
        let mut is_code = false;
        for line in self.text().lines() {
            is_code ^= line.starts_with("```");
            let heading = if is_code { None } else { line.strip_prefix("# ").or(line.strip_prefix("## ")) };
            if let Some(heading) = heading {
                sections.push(Section { heading, markdown: String::new() });
            }
            if let Some(Section { markdown, .. }) = sections.last_mut()
                && (is_code || !(line.starts_with("![") || line.starts_with("<!--")))
            {
                markdown.push_str(line);
                markdown.push('\n');
            }
        }
        sections
    }
}

/// Part of a section: text in Markdown, or a block of code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum SectionPart {
    /// Text in Markdown.
    Text(String),
    /// Content of a fenced code block, without its fences.
    Code(String),
    /// Table with its header as the first row. Each cell is Markdown without line breaks.
    Table(Vec<Vec<String>>),
}

/// Returns the cells of a line of a table, without escapes.
fn cells(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let mut is_escaped = false;
    for c in line.trim().trim_start_matches('|').chars() {
        match (c, cells.last_mut()) {
            ('\\', _) if !is_escaped => {
                is_escaped = true;
                continue;
            }
            ('|', _) if !is_escaped => cells.push(String::new()),
            (c, Some(cell)) => {
                if is_escaped && c != '|' {
                    cell.push('\\');
                }
                cell.push(c);
            }
            (_, None) => {}
        }
        is_escaped = false;
    }
    if line.trim_end().ends_with('|') {
        cells.pop();
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

/// Splits text into paragraphs and tables, and appends them to `parts`.
fn split_tables(text: &str, parts: &mut Vec<SectionPart>) {
    for line in text.split_inclusive('\n') {
        let is_row = line.starts_with('|');
        match parts.last_mut() {
            Some(SectionPart::Table(_)) if is_row && line.starts_with("| ---") => {}
            Some(SectionPart::Table(rows)) if is_row => rows.push(cells(line)),
            Some(SectionPart::Text(text)) if !is_row => text.push_str(line),
            _ if is_row => parts.push(SectionPart::Table(vec![cells(line)])),
            _ => parts.push(SectionPart::Text(line.to_owned())),
        }
    }
}

impl Section {
    /// Returns the parts of the section in reading order.
    pub(crate) fn parts(&self) -> Vec<SectionPart> {
        let mut parts = Vec::new();
        for (index, part) in self.markdown.split("```").enumerate() {
            if index % 2 == 0 {
                split_tables(part, &mut parts);
            } else if let Some((_language, code)) = part.split_once('\n') {
                parts.push(SectionPart::Code(code.trim_end().to_owned()));
            }
        }
        parts.retain(|part| !matches!(part, SectionPart::Text(text) if text.trim().is_empty()));
        parts
    }

    /// Returns the targets of all links in the section.
    pub(crate) fn links(&self) -> impl Iterator<Item = &str> {
        self.markdown.split("](").skip(1).filter_map(|rest| rest.split(')').next())
    }
}

/// Returns the web address of a link that leads outside the manual. A link to another file of the package leads to its
/// page on docs.rs.
pub(crate) fn web_address(link: &str) -> String {
    if link.contains("://") {
        return link.to_owned();
    }
    let path = link.trim_start_matches("../");
    concat!("https://docs.rs/crate/", env!("CARGO_PKG_NAME"), "/", env!("CARGO_PKG_VERSION"), "/source/").to_owned()
        + path
}

/// Returns the sections that contain all words of `query`, ignoring case. Sections whose heading contains all words
/// come first. Both groups are in reading order.
///
/// # Examples
/// ```
/// use rasterscope::manual::{Chapter, find};
///
/// let passages = find("getting STARTED");
/// assert_eq!(passages[0].chapter, Chapter::GettingStarted);
/// assert_eq!(passages[0].heading, Chapter::GettingStarted.title());
/// assert!(find("getting qqqqq").is_empty());
/// ```
pub fn find(query: &str) -> Vec<Passage> {
    let words: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
    let mut found = Vec::new();
    if words.is_empty() {
        return found;
    }
    for chapter in Chapter::ALL {
        for (index, section) in chapter.sections().into_iter().enumerate() {
            let text = section.markdown.to_lowercase();
            if words.iter().all(|word| text.contains(word)) {
                let has_word = |text: &str| words.iter().any(|word| text.to_lowercase().contains(word));
                let line = section.markdown.lines().skip(1).find(|line| has_word(line)).unwrap_or_default();
                found.push(Passage {
                    chapter: *chapter,
                    section: index,
                    heading: section.heading,
                    line: plain(line).into_owned(),
                });
            }
        }
    }
    let has_all = |heading: &str| words.iter().all(|word| heading.to_lowercase().contains(word));
    found.sort_by_key(|passage| !has_all(passage.heading));
    found
}

/// Returns the anchor of a heading, as GitHub generates it.
fn anchor(heading: &str) -> String {
    let text = heading.trim_start_matches('#').trim().to_lowercase();
    text.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Returns a line of Markdown as plain text, without its marks.
fn plain(line: &str) -> Cow<'_, str> {
    let line = line.trim_start_matches(['#', '-', '*', '|', '>', ' ']);
    if line.contains(['*', '`', '|']) { Cow::Owned(line.replace(['*', '`', '|'], "")) } else { Cow::Borrowed(line) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chapter_begins_with_its_title_and_has_distinct_headings() {
        for chapter in Chapter::ALL {
            assert!(chapter.text().starts_with("# "), "{}", chapter.file());
            let headings: Vec<_> = chapter.sections().iter().map(|section| section.heading).collect();
            let distinct: std::collections::BTreeSet<_> = headings.iter().collect();
            assert_eq!(distinct.len(), headings.len(), "{}: {headings:?}", chapter.file());
        }
    }

    #[test]
    fn a_search_finds_headings_first_and_needs_all_words() {
        let found = find("Getting STARTED");
        assert_eq!((found[0].chapter, found[0].section), (Chapter::GettingStarted, 0));
        assert!(find("getting qqqqq").is_empty());
        assert!(find("  ").is_empty());
    }

    #[test]
    fn links_lead_to_the_section_with_the_heading() {
        let from = Chapter::Stability;
        let heading = |(chapter, section): (Chapter, usize)| (chapter, chapter.sections()[section].heading);
        assert_eq!(from.linked_section("#probe").map(heading), Some((from, "Probe")));
        let file = Chapter::Reference.file();
        let keys = from.linked_section(&format!("{file}#keys-and-mouse")).map(heading);
        assert_eq!(keys, Some((Chapter::Reference, "Keys and mouse")));
        assert_eq!(from.linked_section(file), Some((Chapter::Reference, 0)));
        for outside in ["https://example.org/#probe", "#no-such-heading", "no-such-file.md"] {
            assert_eq!(from.linked_section(outside), None, "{outside}");
        }
    }

    #[test]
    fn every_link_to_a_heading_of_the_manual_is_found() {
        let mut count = 0;
        for chapter in Chapter::ALL {
            for link in chapter.sections().iter().flat_map(Section::links).filter(|link| link.contains('#')) {
                if !link.contains("://") && !link.starts_with("..") {
                    assert!(chapter.linked_section(link).is_some(), "{}: {link}", chapter.file());
                    count += 1;
                }
            }
        }
        assert!(count > 10, "{count} links");
    }

    #[test]
    fn tables_are_parts_with_their_header_first() {
        let markdown = "Text.\n\n| a | b |\n| --- | --- |\n| `x\\|y` | [z](t.md) |\nMore.\n".to_owned();
        let parts = Section { heading: "Title", markdown }.parts();
        let [SectionPart::Text(_), SectionPart::Table(rows), SectionPart::Text(last)] = &parts[..] else {
            panic!("{parts:?}")
        };
        assert_eq!(rows, &[["a", "b"], ["`x|y`", "[z](t.md)"]]);
        assert_eq!(last, "More.\n");
    }

    #[test]
    fn every_link_out_of_the_manual_leads_to_a_page_or_a_file_of_the_package() {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
        for chapter in Chapter::ALL {
            for link in chapter.sections().iter().flat_map(Section::links) {
                if chapter.linked_section(link).is_none() && !link.contains("://") {
                    assert!(root.join("assets/manual").join(link).exists(), "{}: {link}", chapter.file());
                    assert!(link.starts_with("../"), "{link}");
                }
            }
        }
        assert!(web_address("../../README.md").ends_with("/source/README.md"));
        assert_eq!(web_address("https://example.org/a"), "https://example.org/a");
    }

    #[test]
    fn code_blocks_are_parts_without_their_fences() {
        let markdown = "## Title\n\nText.\n\n```sh\nrun this\nand that\n```\n\nMore.\n".to_owned();
        let parts = Section { heading: "Title", markdown }.parts();
        let [SectionPart::Text(first), SectionPart::Code(code), SectionPart::Text(last)] = &parts[..] else {
            panic!("{parts:?}")
        };
        assert_eq!((first.trim(), code.as_str(), last.trim()), ("## Title\n\nText.", "run this\nand that", "More."));
    }

    #[test]
    fn pictures_and_markers_are_left_out_but_code_is_not() {
        for section in Chapter::ALL.iter().flat_map(|chapter| chapter.sections()) {
            assert!(!section.markdown.lines().any(|line| line.starts_with("![")), "{}", section.heading);
        }
        let code = Chapter::ALL.iter().flat_map(|chapter| chapter.sections()).any(|s| s.markdown.contains("```sh"));
        assert!(code);
    }
}
