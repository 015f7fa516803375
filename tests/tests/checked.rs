//! The tests are run: each of them, and with overflow checks.

use std::fs;
use std::hint::black_box;
use std::path::Path;

/// Where the tests of a folder are one program, a new file must be told to it.
#[test]
fn every_file_is_in_a_program() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for package in ["tests", "host-sim", "hal-adapter", "core/capi", "host-sim/formats", "host-sim/virtual-rig"] {
        let read = |path: &str| fs::read_to_string(root.join(package).join(path)).unwrap();
        let (program, manifest) = (read("tests/all.rs"), read("Cargo.toml"));
        for entry in fs::read_dir(root.join(package).join("tests")).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            if let Some(name) = name.strip_suffix(".rs") {
                let told = program.contains(&format!("mod {name};\n"));
                assert!(told || manifest.contains(&format!("[[test]]\nname = \"{name}\"\n")), "{package}: {name}");
            }
        }
    }
}

#[test]
#[cfg_attr(not(debug_assertions), ignore = "optimised for release")]
fn overflow_is_found() {
    let sum = std::panic::catch_unwind(|| black_box(u8::MAX) + black_box(1));
    assert!(sum.is_err(), "sums go round in silence");
}
