//! Every program in a README is an example word for word, so that it compiles and runs as copied.

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
