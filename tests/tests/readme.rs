//! What the documentation says of the repository is so: programs in a README are examples word for word, links and files
//! that it names exist.

use std::fs;
use std::path::Path;

#[test]
fn programs_are_examples() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let read = |path: &str| fs::read_to_string(root.join(path)).unwrap();
    let examples = [("rust", read("core/examples/wall.rs")), ("c", read("core/capi/examples/wall.c"))];
    let mut found = 0;
    for readme in ["README.md", "core/README.md", "core/capi/README.md"] {
        let text = read(readme);
        // every second piece is between fences
        for block in text.split("```").skip(1).step_by(2) {
            let (language, program) = block.split_once('\n').unwrap();
            if matches!(language, "rust" | "c") {
                let is_one = |(of, example): &(&str, String)| *of == language && example.ends_with(program);
                assert!(examples.iter().any(is_one), "{readme}: no example is\n{program}");
                found += 1;
            }
        }
    }
    assert_eq!(found, 4);
}

/// The tables of docs/formats.md name a test for each row: `file: function`.
#[test]
fn formats_that_are_listed_are_tested() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let page = fs::read_to_string(root.join("docs/formats.md")).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| ") && !line.ends_with("test |"));
    let mut found = 0;
    for row in rows {
        let test = row.trim_end_matches("` |").rsplit('`').next().unwrap();
        let (file, name) = test.split_once(": ").unwrap_or_else(|| panic!("no test in {row}"));
        let text = fs::read_to_string(root.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        let begins = ["#[test]\nfn", "#[test]\n    fn", "\ndef"].map(|begin| format!("{begin} {name}("));
        assert!(begins.iter().any(|begin| text.contains(begin)), "{test}");
        found += 1;
    }
    assert!(found > 15, "{found}");
}

/// The pages of the documentation, by their paths from the root.
fn pages(root: &Path) -> Vec<String> {
    let docs = fs::read_dir(root.join("docs")).unwrap().map(|entry| entry.unwrap().file_name());
    let docs = docs.map(|name| format!("docs/{}", name.to_str().unwrap())).filter(|path| path.ends_with(".md"));
    docs.chain(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(String::from)).collect()
}

/// Returns the names by which the headings of a page are linked.
fn anchors(page: &str) -> Vec<String> {
    let of = |heading: &str| {
        let kept = heading.trim_start_matches('#').trim().chars().filter(|c| c.is_alphanumeric() || "- _".contains(*c));
        kept.collect::<String>().to_lowercase().replace(' ', "-")
    };
    // every second piece is between fences
    page.split("```").step_by(2).flat_map(str::lines).filter(|line| line.starts_with('#')).map(of).collect()
}

#[test]
fn links_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut found = 0;
    for page in pages(&root) {
        let here = root.join(&page);
        let text = fs::read_to_string(&here).unwrap();
        let links = text.split("```").step_by(2).flat_map(|piece| piece.split("](").skip(1));
        for link in links.map(|link| link.split(')').next().unwrap()).filter(|link| !link.contains("://")) {
            let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
            let there = if path.is_empty() { here.clone() } else { here.with_file_name(path) };
            assert!(there.exists(), "{page}: {link}");
            if !anchor.is_empty() {
                let anchors = anchors(&fs::read_to_string(&there).unwrap());
                assert!(anchors.iter().any(|known| known == anchor), "{page}: {link}: {anchors:?}");
            }
            found += 1;
        }
    }
    assert!(found > 30, "{found}");
}

/// Files that the pages name in code by their path from the root.
#[test]
fn files_that_are_named_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folders = ["core/", "docs/", "fuzz/", "hal-adapter/", "host-sim/", "tests/"];
    let mut found = 0;
    for page in pages(&root) {
        let text = fs::read_to_string(root.join(&page)).unwrap();
        let words = text.split('`').skip(1).step_by(2).flat_map(str::split_whitespace);
        let words = words.map(|word| word.trim_end_matches([':', ',', ')']));
        for path in words.filter(|word| folders.iter().any(|folder| word.starts_with(folder))) {
            assert!(root.join(path).exists(), "{page}: {path}");
            found += 1;
        }
    }
    assert!(found > 40, "{found}");
}

/// The start page links every page.
#[test]
fn pages_are_listed() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let start = fs::read_to_string(root.join("docs/README.md")).unwrap();
    for page in pages(&root).iter().filter_map(|page| page.strip_prefix("docs/")).filter(|page| *page != "README.md") {
        assert!(start.contains(&format!("]({page})")), "{page}");
    }
}
