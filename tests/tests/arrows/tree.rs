//! The modules of a crate, and where the names in them come from.
use std::collections::{BTreeMap, BTreeSet};

use crate::Sources;
use crate::tokens::{is_word, tokens, use_paths, without_tests};

/// Names of modules from the root on, or of a path in the source.
pub type Names = Vec<String>;

#[derive(Default)]
pub struct Tree {
    pub modules: BTreeMap<Names, Module>,
}

#[derive(Default)]
pub struct Module {
    pub file: String,
    children: BTreeSet<String>,
    /// What is defined here.
    items: BTreeSet<String>,
    /// Words outside of `use`.
    words: BTreeSet<String>,
    paths: Vec<Named>,
}

/// A path in the source.
#[derive(Clone)]
struct Named {
    path: Names,
    /// What it is called from then on, if it stands in a `use`; "*" for all that is there.
    name: Option<String>,
    exported: bool,
}

impl Tree {
    pub fn add(&mut self, sources: &Sources, file: &str, path: Names) {
        let module = Module::parse(file, &sources[file]);
        let folder = match file.rsplit_once('/') {
            _ if path.is_empty() => String::new(),
            Some((folder, "mod.rs")) => format!("{folder}/"),
            _ => format!("{}/", file.trim_end_matches(".rs")),
        };
        for child in &module.children {
            let files = [format!("{folder}{child}.rs"), format!("{folder}{child}/mod.rs")];
            let found = files.iter().find(|file| sources.contains_key(*file));
            let found = found.unwrap_or_else(|| panic!("{file}: no file of the module {child}"));
            self.add(sources, found, [&path[..], std::slice::from_ref(child)].concat());
        }
        self.modules.insert(path, module);
    }

    /// Files that a module uses.
    pub fn used_by(&self, path: &[String]) -> BTreeSet<String> {
        let module = &self.modules[path];
        let target = |named: &Named| {
            let (place, _) = self.find(path, &named.path, 0)?;
            let target = &self.modules[&place];
            let here = match named.name.as_deref() {
                Some("*") => module.words.intersection(&target.items).next().is_some(),
                Some(name) => module.words.contains(name),
                None => true,
            };
            (place != path && (here || !named.exported)).then(|| target.file.clone())
        };
        module.paths.iter().filter_map(target).collect()
    }

    /// Returns the module where what a path names is defined, and whether it is that module itself;
    /// None for other crates.
    fn find(&self, from: &[String], path: &[String], depth: usize) -> Option<(Names, bool)> {
        let (first, mut rest) = path.split_first()?;
        let mut at = match first.as_str() {
            "crate" => vec![],
            "self" => from.to_vec(),
            "super" => from.split_last()?.1.to_vec(),
            name if self.modules[from].children.contains(name) => [from, &[name.to_owned()]].concat(),
            name => match self.imported(from, name, depth)? {
                (place, true) => place,
                item => return Some(item),
            },
        };
        while let Some((name, beyond)) = rest.split_first() {
            rest = beyond;
            if name == "super" {
                at.pop()?;
            } else if self.modules[&at].children.contains(name) {
                at.push(name.clone());
            } else {
                match self.imported(&at, name, depth) {
                    Some((place, true)) => at = place,
                    Some(item) => return Some(item),
                    None => return Some((self.macro_of(name).unwrap_or(at), false)),
                }
            }
        }
        Some((at, true))
    }

    /// Where a name of a module comes from, if it comes by `use`.
    fn imported(&self, at: &[String], name: &str, depth: usize) -> Option<(Names, bool)> {
        let module = &self.modules[at];
        if depth > 8 || module.items.contains(name) {
            return None;
        }
        let named = |wanted| module.paths.iter().filter(move |named| named.name.as_deref() == Some(wanted));
        if let Some(found) = named(name).find_map(|named| self.find(at, &named.path, depth + 1)) {
            return Some(found);
        }
        let place = |named: &Named| self.find(at, &named.path, depth + 1).map(|(place, _)| place);
        let place = named("*").filter_map(place).find(|place| self.modules[place].items.contains(name))?;
        Some((place, false))
    }

    /// Macros are exported from the root, wherever they stand.
    fn macro_of(&self, name: &str) -> Option<Names> {
        let wanted = format!("{name}!");
        self.modules.iter().find(|(_, module)| module.items.contains(&wanted)).map(|(path, _)| path.clone())
    }
}

impl Module {
    fn parse(file: &str, source: &str) -> Module {
        let tokens = without_tests(tokens(source));
        let token = |i: usize| tokens.get(i).map_or("", String::as_str);
        let mut module = Module { file: file.to_owned(), ..Module::default() };
        // depths of braces at which modules begin that stand in this file
        let (mut depth, mut inner) = (0, vec![]);
        let mut i = 0;
        while i < tokens.len() {
            match (token(i), token(i + 1), token(i + 2)) {
                // not the `use<..>` of a bound
                ("use", next, _) if next != "<" => {
                    let exported = i > 0 && ["pub", ")"].contains(&token(i - 1));
                    let mut found = vec![];
                    i = use_paths(&tokens, i + 1, &[], &mut found);
                    let named = |(path, name)| Named { path: from_file(path, inner.len()), name: Some(name), exported };
                    module.paths.extend(found.into_iter().map(named));
                    continue;
                }
                ("mod", name, ";") => drop(module.children.insert(name.to_owned())),
                ("macro_rules", "!", name) => drop(module.items.insert(format!("{name}!"))),
                ("mod", _, "{") => inner.push(depth),
                ("{", _, _) => depth += 1,
                ("}", _, _) => {
                    depth -= 1;
                    inner.pop_if(|begin| *begin == depth);
                }
                ("fn" | "struct" | "enum" | "trait" | "union" | "const" | "static" | "type", name, _) => {
                    module.items.insert(name.to_owned());
                }
                (first, "::", _) if is_word(first) && (i == 0 || token(i - 1) != "::") => {
                    let words =
                        (i..).step_by(2).take_while(|at| is_word(token(*at)) && (*at == i || token(at - 1) == "::"));
                    let path = words.map(|at| token(at).to_owned()).collect();
                    module.paths.push(Named { path: from_file(path, inner.len()), name: None, exported: false });
                }
                _ => (),
            }
            module.words.insert(token(i).to_owned());
            i += 1;
        }
        module
    }
}

/// A path that stands in so many modules within a file, as seen from the file.
fn from_file(mut path: Names, inner: usize) -> Names {
    let supers = path.iter().take_while(|name| *name == "super").count().min(inner);
    if supers > 0 {
        path.splice(..supers, ["self".to_owned()]);
    }
    path
}
