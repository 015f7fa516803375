//! Which file uses which, in every crate: no circles, and in the core no approach uses another.
//!
//! A file uses another where it names something of it: by a path from `crate`, `self`, `super` or a
//! module that it declares or imports. What is re-exported belongs to the file that defines it, so
//! a file that only declares and re-exports modules uses none. Comments, literals and items under
//! `#[cfg(test)]` do not count.
//!
//! It needs only the standard library, and so `.ci/run circles` builds it in a second.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

mod tokens;
mod tree;

use tree::Tree;

const CRATES: [&str; 8] = [
    "core",
    "core/capi",
    "hal-adapter",
    "hal-adapter/firmware",
    "host-sim",
    "host-sim/formats",
    "host-sim/virtual-rig",
    "tests",
];
const APPROACHES: [&str; 3] = ["plane/", "edge/", "region/"];
/// The two files of the core that know all approaches.
const ABOVE_APPROACHES: [&str; 2] = ["any.rs", "lib.rs"];

/// Path of a file below `src`, and its text.
type Sources = BTreeMap<String, String>;
/// What each file uses.
type Arrows = BTreeMap<String, BTreeSet<String>>;

#[test]
fn no_circles() {
    let circles_of = |name| circles(&arrows(&sources(name))).into_iter().map(move |circle| format!("{name}: {circle}"));
    let found: Vec<_> = CRATES.into_iter().flat_map(circles_of).collect();
    assert!(found.is_empty(), "files that use each other:\n{}", found.join("\n"));
}

#[test]
fn no_approach_uses_another() {
    let arrows = arrows(&sources("core"));
    for folder in APPROACHES {
        assert!(arrows.keys().any(|file| file.starts_with(folder)), "core/src/{folder} is not there");
    }
    let breaches = breaches(&arrows);
    assert!(breaches.is_empty(), "core:\n{}", breaches.join("\n"));
}

/// Circles as lines of text: the files of each, and what they use of each other.
fn circles(arrows: &Arrows) -> Vec<String> {
    let reached: BTreeMap<_, _> = arrows.keys().map(|from| (from, reached(arrows, from))).collect();
    let on_circle_with = |file: &String| -> Vec<&String> {
        reached[file].iter().filter(|other| reached[*other].contains(file)).copied().collect()
    };
    let circles: BTreeSet<_> = arrows.keys().map(on_circle_with).filter(|circle| !circle.is_empty()).collect();
    let line = |circle: Vec<&String>| {
        let uses = |from: &String| {
            let to: Vec<_> = arrows[from].iter().filter(|to| circle.contains(to)).map(String::as_str).collect();
            format!("{from} -> {}", to.join(", "))
        };
        circle.iter().map(|from| uses(from)).collect::<Vec<_>>().join("; ")
    };
    circles.into_iter().map(line).collect()
}

/// What a file uses, and what that uses, and so on.
fn reached<'a>(arrows: &'a Arrows, from: &str) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut next: Vec<_> = arrows[from].iter().collect();
    while let Some(file) = next.pop() {
        if reached.insert(file) {
            next.extend(&arrows[file]);
        }
    }
    reached
}

/// Uses of an approach by a file that is neither of that approach nor above all approaches.
fn breaches(arrows: &Arrows) -> Vec<String> {
    let all = arrows.iter().flat_map(|(from, all)| all.iter().map(move |to| (from, to)));
    let forbidden = |from: &str, to: &str| {
        !ABOVE_APPROACHES.contains(&from)
            && APPROACHES.iter().any(|folder| to.starts_with(folder) && !from.starts_with(folder))
    };
    all.filter(|(from, to)| forbidden(from, to)).map(|(from, to)| format!("{from} uses {to}")).collect()
}

/// All Rust files of a crate.
fn sources(name: &str) -> Sources {
    fn read(folder: &Path, below: &str, into: &mut Sources) {
        let entries = fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        for path in entries.map(|entry| entry.unwrap().path()) {
            let name = format!("{below}{}", path.file_name().unwrap().to_str().unwrap());
            if path.is_dir() {
                read(&path, &format!("{name}/"), into);
            } else if name.ends_with(".rs") {
                into.insert(name, fs::read_to_string(&path).unwrap());
            }
        }
    }
    let mut sources = Sources::new();
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name).join("src"), "", &mut sources);
    sources
}

fn arrows(sources: &Sources) -> Arrows {
    let mut arrows = Arrows::new();
    for root in sources.keys().filter(|file| ["lib.rs", "main.rs"].contains(&file.as_str())) {
        let mut tree = Tree::default();
        tree.add(sources, root, vec![]);
        for (path, module) in &tree.modules {
            arrows.entry(module.file.clone()).or_default().extend(tree.used_by(path));
        }
    }
    arrows
}

/// Arrows of a crate made of these files.
fn arrows_of(files: &[(&str, &str)]) -> Arrows {
    arrows(&files.iter().map(|(file, source)| (file.to_string(), source.to_string())).collect())
}

#[test]
fn a_circle_is_found() {
    let files = [
        ("lib.rs", "mod a; mod b; mod c; pub use c::Made; pub use a::{self as first, A};"),
        ("a.rs", "use std::fmt; use crate::b::{self, B}; pub struct A;"),
        ("b/mod.rs", "mod deep; pub use deep::B;"),
        ("b/deep.rs", "pub struct B(crate::Made);"),
        ("c.rs", "pub struct Made; fn f() { super::first::f() }"),
    ];
    let arrows = arrows_of(&files);
    assert_eq!(arrows["lib.rs"].len(), 0, "it only declares and re-exports");
    assert_eq!(circles(&arrows), ["a.rs -> b/deep.rs; b/deep.rs -> c.rs; c.rs -> a.rs"]);
}

#[test]
fn a_parent_that_uses_its_child_is_on_the_circle() {
    let child = ("m/child.rs", "use super::*; fn f(_: Parent) {}");
    let with = |parent| circles(&arrows_of(&[("lib.rs", "mod m;"), ("m/mod.rs", parent), child]));
    assert_eq!(with("mod child; pub use child::f; pub struct Parent;").len(), 0);
    assert_eq!(with("mod child; pub use child::f; pub struct Parent; fn g() { f(Parent) }").len(), 1);
    assert_eq!(with("mod child; pub use child::*; pub struct Parent; fn g() { f(Parent) }").len(), 1);
    assert_eq!(with("mod child; pub struct Parent; fn g() { child::f(Parent) }").len(), 1);
    assert_eq!(with("mod child; pub struct Parent; mod inner { fn g() { super::child::f(super::Parent) } }").len(), 1);
}

#[test]
fn what_is_no_code_does_not_count() {
    let b = r##"
        //! [`crate::a`]
        /* use crate::a::A; */
        const TEXTS: [&str; 2] = ["\" crate::a::A", r#"" crate::a::A"#]; const QUOTE: char = '"';
        pub fn b<'a>(x: &'a str) -> &'a str { x }
        #[cfg(test)]
        mod tests { use crate::a::A; fn f() { { } } }
        pub struct B;
    "##;
    let with = |more: &str| {
        arrows_of(&[("lib.rs", "mod a; mod b;"), ("a.rs", "pub struct A;"), ("b.rs", &(b.to_owned() + more))])
    };
    assert_eq!(with("")["b.rs"].len(), 0);
    assert_eq!(with("fn c(_: crate::a::A) {}")["b.rs"].len(), 1);
}

#[test]
fn a_macro_belongs_to_its_file() {
    let lines = "#[macro_export] macro_rules! lines { () => { $crate::a::A } }";
    let files = [("lib.rs", "mod a; mod b;"), ("a.rs", "fn a() { crate::lines!() } pub struct A;"), ("b.rs", lines)];
    assert_eq!(circles(&arrows_of(&files)), ["a.rs -> b.rs; b.rs -> a.rs"]);
}

#[test]
fn an_approach_that_uses_another_is_found() {
    let root = ("lib.rs", "mod any; mod plane; mod edge; mod row; pub use edge::Traces;");
    let files = |edge, row| {
        let any = ("any.rs", "use crate::edge::Traces; use crate::plane::Lines;");
        arrows_of(&[root, any, ("plane/mod.rs", "pub struct Lines;"), ("edge/mod.rs", edge), ("row.rs", row)])
    };
    assert_eq!(breaches(&files("pub struct Traces(crate::row::Row);", "pub struct Row;")).len(), 0);
    assert_eq!(breaches(&files("use crate::plane::Lines; pub struct Traces;", "")), ["edge/mod.rs uses plane/mod.rs"]);
    assert_eq!(breaches(&files("pub struct Traces;", "use crate::Traces;")), ["row.rs uses edge/mod.rs"]);
}
