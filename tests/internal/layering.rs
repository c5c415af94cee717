//! Checks the layering of modules by reading the sources of both crates: imports point only upstream, and only `ui`
//! names the window toolkit.

use std::fs;
use std::path::{Path, PathBuf};

/// Crates that only the module `ui` may name.
const WINDOW_TOOLKIT: [&str; 7] =
    ["egui", "eframe", "egui_plot", "egui_extras", "egui_commonmark", "egui_kittest", "rfd"];

/// Folder of the engine's crate in `src`.
const ENGINE: &str = "engine";

/// Folder of the crate that explains other renderers' pictures in `src`, and its name in imports of the root package.
const EXPLAIN: &str = "explain";

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

/// Returns the modules in the order of their declaration: those of the engine, the crate `explain` as one, those of the
/// root package, and `main`.
/// Each crate's `lib` follows its modules; the engine's is called `rasterscope_engine`, as in imports.
fn order(sources: &[Source]) -> Vec<String> {
    let declared = |library: &str| {
        let library = sources.iter().find(|source| source.path == Path::new(library)).unwrap();
        let name = |line: &str| Some(line.strip_prefix("pub mod ")?.strip_suffix(';')?.to_owned());
        library.code().filter_map(move |(_, line)| name(line)).collect::<Vec<_>>()
    };
    let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    let libraries = names(&["rasterscope_engine", EXPLAIN]);
    [declared("engine/lib.rs"), libraries, declared("lib.rs"), names(&["lib", "main"])].concat()
}

/// Returns the top-level modules that `code` names after `crate::`, `rasterscope::` or `rasterscope_engine::`, singly or
/// within braces.
fn imports(code: &str) -> Vec<String> {
    let prefixes = ["crate::", "rasterscope::", "rasterscope_engine::"];
    let starts = prefixes.iter().flat_map(|prefix| code.match_indices(prefix));
    starts.flat_map(|(at, prefix)| named_modules(&code[at + prefix.len()..])).collect()
}

fn named_modules(rest: &str) -> Vec<String> {
    let Some(group) = rest.strip_prefix('{') else {
        return words(rest).take(1).map(str::to_owned).collect();
    };
    let mut depth = 0;
    let items = group.split(|c| {
        depth += i32::from(c == '{') - i32::from(c == '}');
        c == ',' && depth == 0 || depth < 0
    });
    items.map_while(|item| words(item.trim_start()).next().filter(|word| !word.is_empty())).map(str::to_owned).collect()
}

#[test]
fn imports_point_only_upstream() {
    let sources = sources();
    let order = order(&sources);
    let position = |module: &str| order.iter().position(|m| m == module);
    let mut found = 0;
    for source in &sources {
        let name = source.module();
        let name = if source.is_engine() && name == "lib" { "rasterscope_engine" } else { &name };
        let own = position(name).unwrap_or_else(|| panic!("{} is in no module", source.path.display()));
        let code: String = source.code().flat_map(|(_, line)| [line, "\n"]).collect();
        // Within `explain`, `crate` is that crate, which is one module here.
        let code = if name == EXPLAIN { code.replace("crate::", "") } else { code };
        for import in imports(&code) {
            // Names that are not modules are macros of the crate.
            let Some(imported) = position(&import) else { continue };
            found += 1;
            assert!(imported <= own, "{} imports {import}, which comes after it", source.path.display());
        }
    }
    assert!(found > 50, "only {found} imports seen");
}

#[test]
fn import_groups_are_understood() {
    assert_eq!(imports("use crate::math;"), ["math"]);
    assert_eq!(imports("use crate::{image::{Image, Rgba8}, scene};"), ["image", "scene"]);
    assert_eq!(imports("let x = crate::chain::run(rasterscope::ui::start());"), ["chain", "ui"]);
    assert_eq!(imports("pub use rasterscope_engine::{\n    case, text\n};"), ["case", "text"]);
}

#[test]
fn the_root_package_re_exports_every_module_of_the_engine() {
    let sources = sources();
    let library = &sources.iter().find(|source| source.path == Path::new("lib.rs")).unwrap().text;
    let (_, rest) = library.split_once("pub use rasterscope_engine::").unwrap();
    let mut exported = named_modules(rest);
    exported.sort_unstable();
    let mut modules: Vec<_> = order(&sources).into_iter().take_while(|module| module != "rasterscope_engine").collect();
    modules.sort_unstable();
    assert_eq!(exported, modules);
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
