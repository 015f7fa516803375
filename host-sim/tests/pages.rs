//! Every `scanseg` command in the documentation is one that the program takes, and those of the first
//! pages run as they stand.

use std::fs;
use std::path::{Path, PathBuf};

use crate::program::{folder, scanseg, succeeds};

/// Commands of pages that are run from top to bottom but for these: of minutes, of a scanner, of
/// a feature.
const NOT_RUN: [&str; 3] = ["experiment", "live", "ros2"];

/// Options that the pages name and that are cargo's.
const CARGOS: [&str; 2] = ["--features", "--release"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The pages, by their paths from the root.
fn pages() -> Vec<String> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().file_name());
    let docs = docs.map(|name| format!("docs/{}", name.to_str().unwrap())).filter(|path| path.ends_with(".md"));
    docs.chain(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(String::from)).collect()
}

/// Returns the code of a page: the lines between fences, or what stands between backquotes elsewhere.
fn code(page: &str, fenced: bool) -> Vec<String> {
    let text = fs::read_to_string(root().join(page)).unwrap_or_else(|e| panic!("{page}: {e}"));
    let pieces: Vec<&str> = text.split("```").collect();
    // every second piece is between fences
    let pieces = pieces.into_iter().skip(usize::from(fenced)).step_by(2);
    if fenced {
        pieces.flat_map(str::lines).map(String::from).collect()
    } else {
        pieces.flat_map(|piece| piece.split('`').skip(1).step_by(2)).map(|code| code.replace('\n', " ")).collect()
    }
}

/// Returns the arguments of each `scanseg` in a line of a shell, without comments.
fn commands(line: &str) -> Vec<String> {
    let line = line.split(" #").next().unwrap();
    let of = |command: &str| {
        let command = command.split('>').next().unwrap().trim();
        let by_cargo = || {
            let (cargo, arguments) = command.strip_prefix("cargo run ")?.split_once("-- ")?;
            (!cargo.contains("--example")).then_some(arguments)
        };
        command.strip_prefix("scanseg ").or_else(by_cargo).map(String::from)
    };
    line.split("&&").flat_map(|line| line.split(" | ")).filter_map(of).collect()
}

/// Whether the program is built with what these arguments need.
fn is_built(arguments: &str) -> bool {
    (cfg!(feature = "ros2") || !arguments.starts_with("ros2")) && (cfg!(feature = "ros") || !arguments.contains("mcap"))
}

/// Whether a command is right as far as it goes: clap refuses what is wrong before it comes to `--help`.
fn is_taken(arguments: &str) -> bool {
    scanseg(&root(), &format!("{arguments} --help")).status.success()
}

#[test]
fn commands_of_the_pages_are_taken() {
    let help = String::from_utf8(scanseg(&root(), "--help").stdout).unwrap();
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names: Vec<&str> = listed.map(|line| line.split_whitespace().next().unwrap()).collect();
    let helps = names.iter().map(|name| String::from_utf8(scanseg(&root(), &format!("{name} --help")).stdout).unwrap());
    let helps: Vec<String> = helps.collect();
    let (mut whole, mut options) = (0, 0);
    for page in pages() {
        let (fenced, inline) = (code(&page, true), code(&page, false));
        for arguments in fenced.iter().chain(&inline).flat_map(|line| commands(line)).filter(|line| is_built(line)) {
            assert!(is_taken(&arguments), "{page}: scanseg {arguments}");
            whole += 1;
        }
        // options alone are of any subcommand, or of cargo
        let of_cargo = |code: &str| CARGOS.iter().any(|option| code.starts_with(option));
        let of_ours = |code: &&String| code.starts_with("--") && !of_cargo(code) && is_built(code);
        for option in inline.iter().filter(of_ours) {
            let is_known = match option.split_once(' ') {
                Some((_, value)) if value.contains(|c: char| c.is_lowercase() || c.is_ascii_digit()) => {
                    names.iter().any(|name| is_taken(&format!("{name} {option}")))
                }
                // without a value, or with a NAME of one
                _ => {
                    let of_helps = || helps.iter().flat_map(|help| help.split_whitespace());
                    of_helps().any(|word| option.split(' ').next() == Some(word))
                }
            };
            assert!(is_known, "{page}: {option}");
            options += 1;
        }
    }
    assert!(whole > 20 && options > 10, "{whole} commands, {options} options");
}

/// Names in capitals are the reader's own files.
#[test]
fn commands_of_the_first_pages_run() {
    let mut run = 0;
    for page in ["README", "accuracy-and-speed"] {
        let folder = folder(&format!("pages-{page}"));
        for arguments in code(&format!("docs/{page}.md"), true).iter().flat_map(|line| commands(line)) {
            let own = arguments.contains(|c: char| c.is_ascii_uppercase());
            if !own && !NOT_RUN.iter().any(|name| arguments.starts_with(name)) {
                succeeds(&folder, &arguments);
                run += 1;
            }
        }
    }
    assert!(run > 5, "{run}");
}
