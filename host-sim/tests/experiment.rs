//! The experiment of the paper: what it finds, and the files that its command writes.
use std::fs;
use std::path::Path;
use std::process::Command;

use scanseg_sim::experiment::{METHODS, NOISES_MM, Results, runs, sample::Sample, tables};
use scanseg_sim::office::{SCENES, Set};

/// Everything but the cost: all scenes, methods and levels of noise.
#[test]
fn the_classes_of_all_scenes_are_those_on_record() {
    let set = Set::Tuning;
    let results = Results {
        set,
        scenes: SCENES,
        methods: METHODS.iter().map(|method| method.name).collect(),
        noises_mm: NOISES_MM.to_vec(),
        runs: runs(set, SCENES, || {}),
        sample: Sample::of(set),
        rims: vec![],
        costs: vec![],
    };
    let table = |percent| format!("T = 0.{percent}\n\n{}", tables::classes(&results, percent).markdown());
    insta::assert_snapshot!(tables::TABLE_TOLERANCES.map(table).join("\n"));
}

#[test]
fn the_command_writes_a_page_figures_and_tables() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("experiment");
    let _ = fs::remove_dir_all(&folder);
    let arguments = ["experiment", "--set", "validation", "--scenes", "2", "--out"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_scanseg"));
    let output = command.args(arguments).arg(&folder).output().unwrap();
    let [stdout, stderr] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(output.status.success() && stderr.is_empty(), "{stderr}");
    assert!(stdout.contains("T = 0.9") && stdout.trim_end().ends_with("index.html"), "{stdout}");

    let text = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
    for name in ["scene", "correct", "missed", "split", "cost"] {
        assert!(text(&format!("{name}.svg")).ends_with("</svg>\n"), "{name}");
        let png = fs::read(folder.join(format!("{name}.png"))).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        assert!(pixels.iter().any(|&value| value < 100) && pixels[0] == 255, "{name}");
    }
    let (methods, noises) = (METHODS.len(), NOISES_MM.len());
    let lines = |name: &str| text(name).lines().count();
    assert_eq!(lines("scenes.csv"), 1 + 2 * methods * noises * 2);
    assert_eq!(lines("curves.csv"), 1 + methods * noises * 50);
    assert_eq!(lines("cost.csv"), 1 + methods * 7);
    assert!(
        text("cost.csv").lines().skip(1).all(|line| line.split(',').next_back().unwrap().parse::<f64>().unwrap() > 0.0)
    );
    assert!(stdout.starts_with(&text("tables.md")));
    let page = text("index.html");
    assert!(page.contains("2 scenes of the validation set") && page.contains("<h3>The cost is linear"), "{page}");

    for wrong in [["--scenes", "0"], ["--scenes", "26"], ["--set", "best"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_scanseg"));
        let output = command.arg("experiment").arg("--out").arg(folder.join("wrong")).args(wrong).output().unwrap();
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), stderr.lines().count()), (Some(2), 1), "{stderr}");
        assert!(stderr.contains(wrong[0]) && stderr.contains(wrong[1]) && !folder.join("wrong").exists(), "{stderr}");
    }
}
