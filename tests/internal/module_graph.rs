//! Graph of the modules of all crates by their imports, read from the sources.
//!
//! A module is a file; modules in braces belong to their file. An import counts for the module that defines the item:
//! re-exports are followed.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Path of a module or item: the name of the crate, and the names within it.
pub(crate) type ModulePath = Vec<String>;

/// Crates: folder in `src`, and name in imports.
const CRATES: [(&str, &str); 3] =
    [("engine", "rasterscope_engine"), ("explain", "rasterscope_explain"), ("", "rasterscope")];

/// Path as it is written, and the module that contains it, which may be one in braces.
#[derive(Debug)]
struct Mention {
    within: ModulePath,
    words: Vec<String>,
}

/// Treatment of code in `src` that is compiled only for tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TestCode {
    Included,
    LeftOut,
}

/// A module as it is written.
#[derive(Debug, Default)]
struct Module {
    /// Names of the modules in files of their own, in the order of their declaration.
    children: Vec<String>,
    /// Imports by the name that they define.
    imports: Vec<(String, Mention)>,
    /// Paths outside of imports.
    paths: Vec<Mention>,
}

/// Graph of the modules.
pub(crate) struct ModuleGraph {
    modules: BTreeMap<ModulePath, Module>,
    /// Imports of each module, by the name that they define, as paths from the crate on.
    names: BTreeMap<ModulePath, BTreeMap<String, ModulePath>>,
}

/// Import between two modules of a folder, each of which stands for the modules below it.
pub(crate) type SiblingImport = (String, String);

impl ModuleGraph {
    /// Reads the sources of all crates.
    pub(crate) fn read(test_code: TestCode) -> Self {
        let mut graph = Self { modules: BTreeMap::new(), names: BTreeMap::new() };
        for (folder, name) in CRATES {
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(folder);
            graph.add(&root.join("lib.rs"), &root, &vec![name.to_owned()], test_code);
        }
        let names = graph.modules.iter().map(|(path, module)| {
            let named = module.imports.iter().filter_map(|(name, mention)| {
                let item = graph.absolute(mention, None)?;
                // A module in braces may import an item of its own file.
                (item.split_last() != Some((name, &path[..]))).then(|| (name.clone(), item))
            });
            (path.clone(), named.collect())
        });
        graph.names = names.collect();
        graph
    }

    /// Adds the module in a file, and the modules below it. Files of modules below it lie in `folder`.
    fn add(&mut self, file: &Path, folder: &Path, path: &ModulePath, test_code: TestCode) {
        let text = fs::read_to_string(file).unwrap();
        let mut reader = Reader { tokens: tokens(&text), at: 0, module: Module::default(), test_code };
        reader.items(path);
        let children = reader.module.children.clone();
        self.modules.insert(path.clone(), reader.module);
        for name in children {
            let child = [&path[..], std::slice::from_ref(&name)].concat();
            let files: [PathBuf; 2] = [folder.join(format!("{name}.rs")), folder.join(&name).join("mod.rs")];
            if let Some(file) = files.iter().find(|file| file.is_file() && !self.modules.contains_key(&child)) {
                self.add(file, &folder.join(&name), &child, test_code);
            }
        }
    }

    /// Returns a path from the crate on; `None` if it starts outside of the crates. `imports` are the names that the
    /// module of the path has imported.
    fn absolute(&self, mention: &Mention, imports: Option<&BTreeMap<String, ModulePath>>) -> Option<ModulePath> {
        let (first, rest) = mention.words.split_first()?;
        let mut base = match first.as_str() {
            "crate" => mention.within[..1].to_vec(),
            "self" => mention.within.clone(),
            "super" => mention.within[..mention.within.len() - 1].to_vec(),
            name if CRATES.iter().any(|(_, known)| *known == name) => vec![name.to_owned()],
            name => match imports.and_then(|imports| imports.get(name)) {
                Some(imported) => imported.clone(),
                None => {
                    let child = [&mention.within[..], std::slice::from_ref(first)].concat();
                    self.modules.contains_key(&child).then_some(child)?
                }
            },
        };
        for word in rest {
            if word == "super" { drop(base.pop()) } else { base.push(word.clone()) }
        }
        Some(base)
    }

    /// Returns the module that defines what a path names.
    fn definition(&self, path: &[String]) -> ModulePath {
        let mut path = path.to_vec();
        // Longer chains of re-exports do not occur.
        for _ in 0..10 {
            let length = (0..=path.len()).rev().find(|length| self.modules.contains_key(&path[..*length])).unwrap_or(0);
            let (module, rest) = path.split_at(length);
            let imported = rest.first().and_then(|item| self.names.get(module)?.get(item));
            match imported {
                Some(imported) => path = [&imported[..], &rest[1..]].concat(),
                None => return module.to_vec(),
            }
        }
        panic!("a cycle of re-exports: {path:?}");
    }

    /// Returns the imports between the modules of each folder, each with one of the modules that import.
    pub(crate) fn sibling_imports(&self) -> BTreeMap<ModulePath, BTreeMap<SiblingImport, ModulePath>> {
        let mut folders: BTreeMap<ModulePath, BTreeMap<SiblingImport, ModulePath>> = BTreeMap::new();
        for (path, module) in &self.modules {
            let names = &self.names[path];
            let mentioned = module.paths.iter().filter_map(|mention| self.absolute(mention, Some(names)));
            for item in mentioned.chain(names.values().cloned()) {
                let defined = self.definition(&item);
                let common = path.iter().zip(&defined).take_while(|(a, b)| a == b).count();
                if let (Some(from), Some(to), 1..) = (path.get(common), defined.get(common), common) {
                    let import = (from.clone(), to.clone());
                    folders.entry(path[..common].to_vec()).or_default().entry(import).or_insert(path.clone());
                }
            }
        }
        folders
    }

    /// Returns the names of the modules in a folder, in the order of their declaration.
    pub(crate) fn declared(&self, folder: &[String]) -> Vec<&str> {
        let is_read = |name: &&String| self.modules.contains_key(&[folder, std::slice::from_ref(*name)].concat());
        self.modules[folder].children.iter().filter(is_read).map(String::as_str).collect()
    }

    /// Returns the names that a module imports from the root of another crate.
    pub(crate) fn imported_from<'a>(&'a self, module: &[String], root: &'a str) -> impl Iterator<Item = &'a str> {
        let items = self.names[module].iter();
        items.filter(move |(_, item)| item.len() == 2 && item[0] == root).map(|(name, _)| name.as_str())
    }

    /// Returns the number of modules.
    pub(crate) fn len(&self) -> usize {
        self.modules.len()
    }
}

/// Returns the sets of modules that import each other in a cycle.
pub(crate) fn cycles<'a>(imports: impl Iterator<Item = &'a SiblingImport>) -> Vec<BTreeSet<&'a str>> {
    let mut after: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (from, to) in imports {
        after.entry(from).or_default().insert(to);
    }
    let reached = |from: &'a str| {
        let (mut reached, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(module) = open.pop() {
            open.extend(after.get(module).into_iter().flatten().copied().filter(|next| reached.insert(*next)));
        }
        reached
    };
    let reach: BTreeMap<&str, BTreeSet<&str>> = after.keys().map(|module| (*module, reached(module))).collect();
    let cycle = |module: &&'a str| -> BTreeSet<&'a str> {
        let together = |other: &&&str| reach.get(**other).is_some_and(|reached| reached.contains(module));
        reach[module].iter().filter(together).copied().collect()
    };
    let all: BTreeSet<BTreeSet<&str>> = reach.keys().map(cycle).filter(|cycle| !cycle.is_empty()).collect();
    all.into_iter().collect()
}

/// Reader of the tokens of a file.
struct Reader<'a> {
    tokens: Vec<&'a str>,
    at: usize,
    module: Module,
    test_code: TestCode,
}

impl<'a> Reader<'a> {
    fn token(&self, ahead: usize) -> &'a str {
        self.tokens.get(self.at + ahead).copied().unwrap_or("")
    }

    /// Reads items up to the brace that closes the module `within`, or to the end of the file.
    fn items(&mut self, within: &ModulePath) {
        let mut depth = 0_u32;
        while self.at < self.tokens.len() {
            match (self.token(0), self.token(1)) {
                ("#", "[") => {
                    if self.attribute() && self.test_code == TestCode::LeftOut {
                        self.skip_item();
                    }
                    continue;
                }
                ("mod", name) if is_word(name) && self.token(2) == ";" => self.module.children.push(name.to_owned()),
                ("mod", name) if is_word(name) && self.token(2) == "{" => {
                    self.at += 3;
                    self.items(&[&within[..], &[name.to_owned()]].concat());
                    continue;
                }
                ("use", _) => {
                    self.at += 1;
                    self.import(within, &[]);
                    continue;
                }
                ("{", _) => depth += 1,
                ("}", _) if depth == 0 => {
                    self.at += 1;
                    return;
                }
                ("}", _) => depth -= 1,
                (word, "::") if is_word(word) => {
                    let words = self.path();
                    self.module.paths.push(Mention { within: within.clone(), words });
                    continue;
                }
                _ => {}
            }
            self.at += 1;
        }
    }

    /// Reads an attribute. Returns whether it says that the next item is compiled only for tests.
    fn attribute(&mut self) -> bool {
        let start = self.at;
        self.skip_brackets("[", "]");
        let words = &self.tokens[start..self.at];
        words.contains(&"cfg") && words.contains(&"test") && !words.contains(&"not")
    }

    /// Skips the next item with its attributes.
    fn skip_item(&mut self) {
        while self.token(0) == "#" {
            self.skip_brackets("[", "]");
        }
        let is_import = (0..6)
            .take_while(|ahead| !["{", ";"].contains(&self.token(*ahead)))
            .any(|ahead| self.token(ahead) == "use");
        while self.at < self.tokens.len() && self.token(0) != ";" && (is_import || self.token(0) != "{") {
            self.at += 1;
        }
        if self.token(0) == "{" { self.skip_brackets("{", "}") } else { self.at += 1 }
    }

    /// Skips everything up to the bracket that closes the next opening one.
    fn skip_brackets(&mut self, open: &str, close: &str) {
        let mut depth = 0;
        while self.at < self.tokens.len() {
            depth += i32::from(self.token(0) == open) - i32::from(self.token(0) == close);
            self.at += 1;
            if depth == 0 && self.tokens[self.at - 1] == close {
                return;
            }
        }
    }

    /// Reads words that are joined by `::`.
    fn path(&mut self) -> Vec<String> {
        let mut words = vec![self.token(0).to_owned()];
        self.at += 1;
        while self.token(0) == "::" && is_word(self.token(1)) {
            words.push(self.token(1).to_owned());
            self.at += 2;
        }
        words
    }

    /// Reads the tree of an import that follows `prefix`.
    fn import(&mut self, within: &ModulePath, prefix: &[String]) {
        let mut words = prefix.to_vec();
        loop {
            match self.token(0) {
                "::" => {}
                "{" => {
                    self.at += 1;
                    while self.token(0) != "}" {
                        self.import(within, &words);
                        self.at += usize::from(self.token(0) == ",");
                    }
                    self.at += 1;
                    return;
                }
                "as" => {
                    self.at += 1;
                    break;
                }
                word if is_word(word) => words.push(word.to_owned()),
                // The names of a glob import are unknown, but its module is known.
                "*" => {}
                _ => break,
            }
            self.at += 1;
        }
        if words.len() > 1 && words.last().is_some_and(|last| last == "self") {
            words.pop();
        }
        let name = words.last().cloned().unwrap_or_default();
        let name =
            if is_word(self.token(0)) && self.tokens[self.at - 1] == "as" { self.token(0).to_owned() } else { name };
        self.at += usize::from(is_word(self.token(0)));
        self.module.imports.push((name, Mention { within: within.clone(), words }));
    }
}

fn is_word(token: &str) -> bool {
    token.starts_with(|letter: char| letter.is_alphabetic() || letter == '_')
}

/// Splits a source into words, `::` and other characters, without comments, literals and white space.
fn tokens(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if let Some(length) = raw_string(rest) {
            length
        } else if first == '"' {
            quoted(rest)
        } else if first == '\'' {
            // A lifetime, or a character.
            let inner = rest[1..].chars().next().map_or(0, |inner| if inner == '\\' { 2 } else { inner.len_utf8() });
            let end = rest[1 + inner..].find('\'').map(|end| 2 + inner + end);
            end.filter(|end| *end <= 2 + inner || rest[1..].starts_with('\\')).unwrap_or(1)
        } else if is_word(rest) {
            rest.find(|letter: char| !(letter.is_alphanumeric() || letter == '_')).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        let (token, after) = rest.split_at(length);
        let is_literal = token.starts_with(['"', '\'']) || raw_string(token).is_some();
        if !token.starts_with("//") && !is_literal && !first.is_whitespace() {
            tokens.push(token);
        }
        rest = after;
    }
    tokens
}

/// Returns the length of a raw string literal; `None` if the text does not start with one.
fn raw_string(text: &str) -> Option<usize> {
    let opening = text.strip_prefix('r')?;
    let hashes = opening.len() - opening.trim_start_matches('#').len();
    let content = opening[hashes..].strip_prefix('"')?;
    let closing = format!("\"{}", &opening[..hashes]);
    Some(text.len() - content.len() + content.find(&closing)? + closing.len())
}

/// Returns the length of a string literal, up to its closing quote.
fn quoted(text: &str) -> usize {
    let mut is_escaped = false;
    let end = text[1..].find(|letter| {
        let is_end = letter == '"' && !is_escaped;
        is_escaped = letter == '\\' && !is_escaped;
        is_end
    });
    end.map_or(text.len(), |end| end + 2)
}

#[test]
fn cycles_are_found() {
    let import = |from: &str, to: &str| (from.to_owned(), to.to_owned());
    let imports = [import("a", "b"), import("b", "c"), import("c", "b"), import("c", "d"), import("d", "e")];
    assert_eq!(cycles(imports.iter()), [BTreeSet::from(["b", "c"])]);
}

#[test]
fn sources_are_split_into_tokens() {
    let text = "use a::{b as c}; // d::e\nlet x: &'a str = \"f::\\\"g\"; let y = ('{', '\\'', 'ä', r#\"\"{\"#);";
    let joined = tokens(text).join(" ");
    assert_eq!(joined, "use a :: { b as c } ; let x : & a str = ; let y = ( , , , ) ;");
}
