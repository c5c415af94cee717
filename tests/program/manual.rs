//! Checks that the manual agrees with the program: its tables equal the registries, its commands run, and its links
//! have targets.
//!
//! `RASTERSCOPE_BLESS=1 cargo test --test program manual::` regenerates the tables.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use rasterscope::chain::{Recipe, SettingKey};
use rasterscope::explain::{self, Kind};
use rasterscope::inspect::buffers::{Buffer, BufferChannels};
use rasterscope::inspect::intermediate::Intermediate;
use rasterscope::inspect::overlays::Overlay;
use rasterscope::manual::Chapter;
use rasterscope::pipeline::settings::Choice as _;
use rasterscope::scene::{SceneFormat, builtin};
use rasterscope::ui::key_sheet::keys_and_descriptions;
use rasterscope::upscale::{self, Sampling, Scale, Upscaler, Upscaling};

/// Path of the program under test.
const PROGRAM: &str = env!("CARGO_BIN_EXE_rasterscope");

/// Function that returns a generated table as Markdown.
type Build = fn() -> String;

/// Functions that generate tables, by the name in the table's marker.
const TABLES: [(&str, Build); 9] = [
    ("settings", settings),
    ("upscalers", upscalers),
    ("scenes", scenes),
    ("models", models),
    ("commands", commands),
    ("keys", keys),
    ("buffers", buffers),
    ("overlays", overlays),
    ("faults", faults),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/manual")
}

/// Returns a Markdown table; `|` within cells is escaped.
fn table(header: &str, rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let columns = header.matches('|').count() + 1;
    let mut text = format!("| {header} |\n|{}\n", " --- |".repeat(columns));
    for row in rows {
        let cells: Vec<_> = row.iter().map(|cell| cell.replace('|', "\\|")).collect();
        text.push_str(&format!("| {} |\n", cells.join(" | ")));
    }
    text
}

fn code(text: &str) -> String {
    format!("`{text}`")
}

/// Formats a comma-separated list of words as code. Leaves a condition after the list, and any other text, unchanged.
fn values(text: &str) -> String {
    let (list, condition) = text.split_once(", where ").map_or((text, None), |(list, rest)| (list, Some(rest)));
    let is_word = |word: &str| word.chars().all(|c| c.is_ascii_alphanumeric() || "-.#".contains(c));
    if !list.contains(", ") || !list.split(", ").all(is_word) {
        return text.to_owned();
    }
    let list = list.split(", ").map(code).collect::<Vec<_>>().join(", ");
    condition.map_or_else(|| list.clone(), |condition| format!("{list}, where {condition}"))
}

fn faults() -> String {
    let kind = |kind: Kind| match kind {
        Kind::Error => "",
        Kind::Convention => "convention",
        Kind::Input => "input",
    };
    let rows = explain::ALL.iter();
    let rows = rows.map(|fault| vec![code(fault.id), fault.name.to_owned(), kind(fault.kind).to_owned()]);
    table("fault | what the other renderer does | no error, but another", rows)
}

fn settings() -> String {
    let defaults = Recipe::default();
    // The mask is too long to be listed.
    let default = |key: SettingKey| match key {
        SettingKey::PostMask => "identity".to_owned(),
        _ => code(&key.read(&defaults)),
    };
    let rows = SettingKey::ALL.iter();
    let rows = rows.map(|key| vec![code(key.id()), values(&key.values().to_string()), default(*key)]);
    table("key | values | default", rows)
}

/// Describes the samples that an upscaler draws at its default scale.
fn drawn(upscaler: &dyn Upscaler) -> &'static str {
    let how = Upscaling::new(upscaler.id(), upscaler.default_scale()).expect("an upscaler of the registry");
    let is_drawn = |x| match how.sampling() {
        Sampling::Grid(grid) => grid.sample_at(x, 0).is_some(),
        Sampling::Lattice(_) => false,
    };
    match ([1, 2].map(is_drawn), upscaler.jitter(how).is_some()) {
        (_, true) if upscaler.offers().scales.contains(&Scale::ONE) => {
            "one jittered sample per pixel or block and frame"
        }
        (_, true) => "one jittered sample per block and frame",
        ([true, true], false) => "every pixel",
        ([true, false], false) if upscaler.reads().history => {
            "the 2 × 2-px squares of both colours of a checkerboard, in alternating frames"
        }
        ([true, false], false) => "the 2 × 2-px squares of one colour of a checkerboard",
        ([false, _], false) => "one sample per block",
    }
}

fn upscalers() -> String {
    let rows = upscale::BUILT_IN.iter().map(|upscaler| {
        let altered = if upscaler.alters_samples() { "; drawn pixels change" } else { "" };
        vec![code(upscaler.id()), drawn(*upscaler).to_owned(), format!("{}{altered}", upscaler.artefacts())]
    });
    table("method | what is drawn | artefacts", rows)
}

fn models() -> String {
    let rows = SceneFormat::ALL.iter().map(|format| {
        let extensions: Vec<_> = format.extensions.iter().map(|extension| code(&format!(".{extension}"))).collect();
        vec![format.name.to_owned(), extensions.join(", "), format.companions.to_owned()]
    });
    table("format | file extensions | files beside it", rows)
}

fn scenes() -> String {
    let rows = builtin::ALL.iter().map(|scene| {
        let triangles = scene.build().triangle_count().to_string();
        vec![code(scene.id), triangles, scene.summary.to_owned()]
    });
    table("id | triangles | what it shows", rows)
}

/// Returns the commands with their summaries, taken from the program's help.
fn command_summaries() -> Vec<(String, String)> {
    let output = Command::new(PROGRAM).arg("--help").output().expect("the program starts");
    let help = String::from_utf8(output.stdout).expect("UTF-8");
    let list = help.split_once("Commands:\n").expect("a list of commands").1.split("\n\n").next().unwrap_or_default();
    let mut rows: Vec<(String, String)> = Vec::new();
    for line in list.lines() {
        let name = line.strip_prefix("  ").filter(|rest| !rest.starts_with(' '));
        if let Some((name, summary)) = name.and_then(|rest| rest.split_once(' ')) {
            rows.push((name.to_owned(), summary.trim().to_owned()));
        } else if let Some((_, summary)) = rows.last_mut() {
            *summary = format!("{summary} {}", line.trim());
        }
    }
    rows.retain(|(name, _)| name != "help");
    assert!(rows.len() > 10, "{help}");
    rows
}

fn commands() -> String {
    let rows = command_summaries().into_iter().map(|(name, summary)| vec![code(&name), summary]);
    table("command | what it does", rows)
}

fn keys() -> String {
    let rows = keys_and_descriptions().into_iter().map(|(keys, what)| vec![keys, what.to_owned()]);
    table("keys and mouse | what they do", rows)
}

fn buffers() -> String {
    let row = |id: &str, name: &str, help: &str| vec![code(id), name.to_owned(), help.to_owned()];
    let of_frame = Buffer::ALL.iter().map(|buffer| row(buffer.id(), buffer.name(), buffer.help()));
    let of_fragment = Intermediate::ALL.iter().map(|value| row(value.id(), value.name(), value.help()));
    table("id | name | what it holds", of_frame.chain(of_fragment))
}

fn overlays() -> String {
    let rows = Overlay::ALL
        .iter()
        .map(|overlay| vec![code(overlay.id()), overlay.name().to_owned(), overlay.help().to_owned()]);
    table("id | name | what it shows", rows)
}

/// Returns `text` with the content between the markers of a table replaced, or `None` if it has no such table.
fn with_table(text: &str, name: &str, table: &str) -> Option<String> {
    let marker = format!("<!-- generated: {name} -->\n");
    let start = text.find(&marker)? + marker.len();
    let end = start + text[start..].find("<!-- end -->").expect("the table has an end marker");
    Some(format!("{}{table}{}", &text[..start], &text[end..]))
}

#[test]
fn tables_equal_the_registries() {
    let blesses = std::env::var_os("RASTERSCOPE_BLESS").is_some();
    let mut missing: BTreeSet<&str> = TABLES.iter().map(|(name, _)| *name).collect();
    let mut stale = Vec::new();
    for chapter in Chapter::ALL {
        let path = folder().join(chapter.file());
        let text = std::fs::read_to_string(&path).expect("the chapter is readable");
        let mut expected = text.clone();
        for (name, table) in TABLES {
            if let Some(renewed) = with_table(&expected, name, &table()) {
                missing.remove(name);
                expected = renewed;
            }
        }
        if expected != text {
            stale.push(chapter.file());
            if blesses {
                std::fs::write(&path, expected).expect("the chapter is writable");
            }
        }
    }
    assert!(missing.is_empty(), "no chapter has the tables {missing:?}");
    assert!(
        stale.is_empty() || blesses,
        "stale: {stale:?}; run `RASTERSCOPE_BLESS=1 cargo test --test program manual::`"
    );
}

/// Returns the code blocks of a chapter that are marked with `language`.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let start = format!("```{language}\n");
    text.split(&start).skip(1).map(|rest| rest.split("\n```").next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn every_command_block_runs() {
    let mut count = 0;
    for chapter in Chapter::ALL {
        let scratch = tempfile::tempdir().expect("a temporary folder");
        for block in blocks(chapter.text(), "sh") {
            let script = format!("set -e\nrasterscope() {{ \"{PROGRAM}\" \"$@\"; }}\n{block}\n");
            // Without a display, the program draws the window into a picture.
            let output = Command::new("sh")
                .args(["-c", &script])
                .current_dir(scratch.path())
                .env_remove("DISPLAY")
                .env_remove("WAYLAND_DISPLAY")
                .env("HOME", scratch.path())
                .output()
                .expect("a shell");
            let errors = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}:\n{block}\n{errors}", chapter.file());
            count += 1;
        }
    }
    assert!(count > 20, "{count} blocks");
}

/// Returns the anchor of a heading, as GitHub generates it.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase();
    kept.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn every_link_and_picture_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<PathBuf> = Chapter::ALL.iter().map(|chapter| folder().join(chapter.file())).collect();
    files.push(folder().join("README.md"));
    files.extend(["README.md", "src/README.md", ".github/CONTRIBUTING.md"].map(|file| root.join(file)));
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        for link in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            if link.starts_with("http") {
                continue;
            }
            let (path, heading) = link.split_once('#').unwrap_or((link, ""));
            let target = if path.is_empty() { file.clone() } else { file.parent().expect("a folder").join(path) };
            assert!(target.exists(), "{}: {link}", file.display());
            if !heading.is_empty() {
                let text = std::fs::read_to_string(&target).expect("a page");
                let headings = text.lines().filter(|line| line.starts_with('#'));
                let mut anchors = headings.map(|line| anchor(line.trim_start_matches('#').trim()));
                assert!(anchors.any(|known| known == heading), "{}: {link}", file.display());
            }
        }
    }
}

#[test]
fn the_chapter_on_files_names_every_channel() {
    let text = Chapter::ScenesAndFileFormats.text();
    let is_named = |name: &str| assert!(text.contains(&code(name)), "{name}");
    for buffer in Buffer::ALL {
        match buffer.channels() {
            BufferChannels::Color(names) => names.into_iter().for_each(is_named),
            BufferChannels::Weights(names) => names.into_iter().for_each(is_named),
            BufferChannels::Number(name) | BufferChannels::Count(name) | BufferChannels::Triangle(name) => {
                is_named(name);
            }
        }
    }
}

#[test]
fn every_command_has_an_example_that_runs() {
    let examples: String = Chapter::ALL.iter().flat_map(|chapter| blocks(chapter.text(), "sh")).collect();
    for (name, _) in command_summaries() {
        // Without the name of a command, the window opens.
        assert!(name == "window" || examples.contains(&format!("rasterscope {name}")), "{name}");
    }
}

#[test]
fn the_table_of_contents_lists_every_chapter_in_order() {
    let contents = std::fs::read_to_string(folder().join("README.md")).expect("a table of contents");
    let places: Vec<_> = Chapter::ALL
        .iter()
        .map(|chapter| contents.find(&format!("({})", chapter.file())).unwrap_or_else(|| panic!("{}", chapter.file())))
        .collect();
    assert!(places.is_sorted());
    let files = std::fs::read_dir(folder()).expect("the folder of the manual").count();
    assert_eq!(files, Chapter::ALL.len() + 1, "every page is a chapter");
}
