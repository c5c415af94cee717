//! Checks the layering of modules by reading the sources of all crates: imports point only upstream, and only `ui`
//! names the window toolkit.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::module_graph::{ModuleGraph, ModulePath, TestCode};

/// Crates that only the module `ui` may name.
const WINDOW_TOOLKIT: [&str; 7] =
    ["egui", "eframe", "egui_plot", "egui_extras", "egui_commonmark", "egui_kittest", "rfd"];

/// Folder of the engine's crate in `src`.
const ENGINE: &str = "engine";

/// Markers of unfinished work, split so that this file does not contain them.
const UNFINISHED: [[&str; 2]; 4] = [["TO", "DO"], ["FIX", "ME"], ["unimple", "mented"], ["to", "do"]];

/// A source file: its path relative to `src`, and its text.
struct Source {
    path: PathBuf,
    text: String,
}

impl Source {
    /// Returns whether the file belongs to the engine.
    fn is_engine(&self) -> bool {
        self.path.starts_with(ENGINE)
    }

    /// Returns the top-level module of its crate that the file belongs to.
    fn module(&self) -> String {
        let within_crate = self.path.strip_prefix(ENGINE).unwrap_or(&self.path);
        let first = within_crate.iter().next().unwrap_or_default();
        Path::new(first).with_extension("").display().to_string()
    }

    /// Returns the lines of code without comments, numbered from 1.
    fn code(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text.lines().enumerate().map(|(index, line)| (index + 1, line.split("//").next().unwrap_or_default()))
    }
}

/// Returns all sources except build scripts, which are crates of their own.
fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut sources = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("build.rs") {
                let text = fs::read_to_string(&path).unwrap();
                sources.push(Source { path: path.strip_prefix(&root).unwrap().to_owned(), text });
            }
        }
    }
    sources
}

/// Splits text into identifiers: runs of letters, digits and underscores.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
}

/// Returns the path of the root of a crate.
fn root(name: &str) -> ModulePath {
    vec![name.to_owned()]
}

#[test]
fn imports_point_only_upstream() {
    let graph = ModuleGraph::read(TestCode::Included);
    let imports = graph.sibling_imports();
    // In `explain`, all modules are one layer.
    for (name, least) in [("rasterscope_engine", 50), ("rasterscope", 2)] {
        let order = graph.declared(&root(name));
        let position = |module: &str| order.iter().position(|declared| *declared == module);
        let imports = &imports[&root(name)];
        assert!(imports.len() >= least, "only {} imports seen in {name}", imports.len());
        for ((from, to), module) in imports {
            assert!(position(to) < position(from), "{} imports {to}, which comes after it", module.join("::"));
        }
    }
}

#[test]
fn the_root_package_re_exports_every_module_of_the_engine() {
    let graph = ModuleGraph::read(TestCode::LeftOut);
    let exported: BTreeSet<_> = graph.imported_from(&root("rasterscope"), "rasterscope_engine").collect();
    assert_eq!(exported, graph.declared(&root("rasterscope_engine")).into_iter().collect());
}

#[test]
fn only_the_window_names_its_toolkit() {
    for source in sources().iter().filter(|source| source.is_engine() || source.module() != "ui") {
        let named = words(&source.text).find(|word| WINDOW_TOOLKIT.contains(word));
        assert_eq!(named, None, "in {}", source.path.display());
    }
}

#[test]
fn number_fields_are_made_by_the_widgets() {
    // A field of the toolkit itself rounds its value when it loses the focus.
    let is_widgets = |path: &Path| path.with_extension("").starts_with("ui/widgets");
    for source in sources().iter().filter(|source| !is_widgets(&source.path)) {
        let found = source.code().find(|(_, line)| line.contains("DragValue::new("));
        assert_eq!(found, None, "in {}", source.path.display());
    }
}

#[test]
fn sources_contain_no_markers_of_unfinished_work() {
    let marks = UNFINISHED.map(|halves| halves.concat());
    for source in sources() {
        let mark = words(&source.text).find(|word| marks.iter().any(|mark| mark == word));
        assert_eq!(mark, None, "in {}", source.path.display());
    }
}

/// Returns the files with the extension `rs` below a folder.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|path| if path.is_dir() { rust_files(&path) } else { vec![path] });
    files.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// A file that no module declares is never compiled, so its tests never run.
#[test]
fn every_file_is_declared_as_a_module() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let roots =
        ["src/lib.rs", "src/engine/lib.rs", "Cargo.toml"].map(|path| fs::read_to_string(root.join(path)).unwrap());
    for folder in ["src", "tests/internal", "tests/fuzz", "tests/program", "tests/explain"] {
        for file in rust_files(&root.join(folder)) {
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            if ["mod", "main", "lib", "build"].contains(&name.as_str()) {
                continue;
            }
            let parent = file.parent().unwrap();
            let siblings = fs::read_dir(parent).unwrap().map(|entry| entry.unwrap().path());
            let above = siblings.chain([parent.with_extension("rs")]).filter(|path| *path != file);
            let texts = above.filter_map(|path| fs::read_to_string(path).ok()).chain(roots.clone());
            let declaration = format!("mod {name};");
            let is_declared = texts.into_iter().any(|text| {
                text.lines()
                    .map(str::trim)
                    .any(|line| line == declaration || line.ends_with(&format!(" {declaration}")))
                    || text.contains(&format!("{name}.rs\"]"))
                    || text.contains(&format!("/{name}.rs\"\n"))
            });
            assert!(is_declared, "{} is in no module", file.display());
        }
    }
}
