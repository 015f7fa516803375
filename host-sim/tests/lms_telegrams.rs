//! Raw telegrams of an LMS 2xx that are no complete scan lines: partial scan lines, sub-ranges,
//! means. `scanseg replay` finds the planes of the scene in them.

use std::path::Path;
use std::process::Command;

/// Replays a case of the folder shared with the project. Returns what it prints; `None` where the
/// folder is absent.
fn replay(case: &str, bytes: &str, geometry: &str) -> Option<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases").join(case);
    if !folder.exists() {
        println!("skipped: no {}", folder.display());
        return None;
    }
    let output = Command::new(env!("CARGO_BIN_EXE_scanseg"))
        .args(["replay", "--range-bits", "13", "--geometry"])
        .arg(folder.join(geometry))
        .arg(folder.join(bytes))
        .output()
        .expect("it runs");
    let text = String::from_utf8(output.stdout).expect("text");
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    Some(text)
}

/// Distance and normal of each plane of a size, and pixels.
fn planes(text: &str) -> Vec<(f64, [f64; 3], u32)> {
    let plane = |line: &str| {
        let pixels: u32 = line.split_once(": ")?.1.split_once(" pixels")?.0.parse().ok()?;
        let (distance, rest) = line.split_once("plane at ")?.1.split_once(" m, normal (")?;
        let normal: Vec<f64> = rest.split_once(')')?.0.split(", ").map(|n| n.parse().expect("a number")).collect();
        Some((distance.parse().expect("a number"), normal.try_into().expect("three"), pixels))
    };
    text.lines().filter_map(plane).collect()
}

#[test]
fn planes_of_other_telegrams() {
    let [interlaced, others] = ["07-lms-interlaced-telegrams", "08-lms-subrange-mean-telegrams"];
    for (case, bytes, geometry) in [
        (interlaced, "half-degree.bin", "half-degree.toml"),
        (interlaced, "half-degree.bin", "half-degree-361.toml"),
        (interlaced, "half-degree-180-first.bin", "half-degree.toml"),
        (interlaced, "quarter-degree.bin", "quarter-degree.toml"),
        (others, "subrange-b7.bin", "subrange-b7.toml"),
        (others, "mean-b6.bin", "mean-b6.toml"),
    ] {
        let Some(text) = replay(case, bytes, geometry) else { return };
        assert!(text.contains("40 telegrams, 0 lost, 0 rejected, 40 rows"), "{bytes}: {text}");
        let planes = planes(&text);
        // floor, front, and the sides; of 100 degrees one side alone is seen
        let walls = [(1.0, [0.0, 0.0, 1.0]), (4.0, [-0.940, 0.342, 0.0]), (3.0, [-0.342, -0.940, 0.0])];
        for (distance_m, normal) in walls {
            let found = planes.iter().any(|(d, n, pixels)| {
                let off = n.iter().zip(normal).fold(0.0f64, |off, (a, b)| off.max((a - b).abs()));
                (d - distance_m).abs() < 0.003 && off < 0.002 && *pixels > 900
            });
            assert!(found, "{bytes}, {geometry}: no plane at {distance_m} m in {text}");
        }
    }
}

/// What is not of one variant is refused.
#[test]
fn geometry_must_fit() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/cases/07-lms-interlaced-telegrams");
    if !folder.exists() {
        println!("skipped: no {}", folder.display());
        return;
    }
    let geometry = std::fs::read_to_string(folder.join("half-degree.toml")).expect("text");
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("two-degrees.toml");
    std::fs::write(&path, geometry.replace("step = 1.0", "step = 2.0")).expect("writes");
    let output = Command::new(env!("CARGO_BIN_EXE_scanseg"))
        .args(["replay", "--range-bits", "13", "--geometry"])
        .args([&path, &folder.join("half-degree.bin")])
        .output()
        .expect("it runs");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && errors.contains("181 columns need the geometry"), "{errors}");
}
