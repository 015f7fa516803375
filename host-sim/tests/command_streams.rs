//! The `scanseg` command among other programs: pipes, devices, signals, terminals.
#![cfg(unix)]

use std::fs::{self, File};
use std::io::{Read, Write};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use scanseg_formats::GreyImage;
use scanseg_hal::link::{FrameEncoder, MAX_FRAME, Message, VERSION};

use crate::program::{fails, folder, scanseg, succeeds};

const GEOMETRY: &str = "version = 1\nunit_m = 0.001\nrange_noise_m = 0.01\nkind = \"pinhole\"\ndepth = \"range\"\n\
     fx = 30.0\nfy = 30.0\ncx = 8.0\ncy = 8.0\n";
const SEGMENT: &str = "segment scan.pgm --geometry geometry.toml --out out";

fn small_scan(folder: &Path) {
    let image = GreyImage { rows: 16, columns: 16, max_value: 65535, values: vec![2000; 256] };
    fs::write(folder.join("scan.pgm"), image.to_pgm()).unwrap();
    fs::write(folder.join("geometry.toml"), GEOMETRY).unwrap();
}

fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_scanseg"));
    command.current_dir(folder).args(arguments.split_whitespace()).stdin(Stdio::null());
    command
}

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn frames(messages: &[Message]) -> Vec<u8> {
    let (mut encoder, mut bytes, mut frame) = (FrameEncoder::new(), vec![], [0; MAX_FRAME]);
    for message in messages {
        bytes.extend(encoder.encode(message, &mut frame).unwrap());
    }
    bytes
}

/// A result that cannot take the place of what is there is seen before anything is written.
#[test]
fn a_folder_in_the_place_of_a_file_leaves_all_files_old() {
    let folder = folder("folder-in-place");
    small_scan(&folder);
    fs::create_dir_all(folder.join("out/segments.csv")).unwrap();
    fs::write(folder.join("out/labels.png"), "old").unwrap();
    fails(&folder, SEGMENT, &["out/segments.csv", "directory"]);
    assert_eq!(names(&folder.join("out")), ["labels.png", "segments.csv"]);
    assert_eq!(fs::read(folder.join("out/labels.png")).unwrap(), b"old");
}

/// A pipe among the results holds the program up where all files are there under temporary names.
#[test]
fn signals_leave_no_temporary_file() {
    for signal in ["INT", "TERM"] {
        let folder = folder(&format!("signal-{signal}"));
        small_scan(&folder);
        let out = folder.join("out");
        fs::create_dir(&out).unwrap();
        pipe(&out.join("segments.json"));
        fs::write(out.join("labels.png"), "old").unwrap();
        let mut child = command(&folder, SEGMENT).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let temporary = |name: &String| name.ends_with(".tmp");
        while names(&out).iter().filter(|name| temporary(name)).count() < 8 {
            assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
            sleep(Duration::from_millis(5));
        }
        kill(&child, signal);
        assert!(!child.wait().unwrap().success());
        assert_eq!(names(&out), ["labels.png", "segments.json"], "{signal}");
        assert_eq!(fs::read(out.join("labels.png")).unwrap(), b"old");
    }
}

fn kill(child: &Child, signal: &str) {
    let status = Command::new("kill").arg(format!("-{signal}")).arg(child.id().to_string()).status().unwrap();
    assert!(status.success());
}

/// `... | head -1` ends although more frames could come.
#[test]
fn a_reader_that_has_gone_ends_the_program() {
    let folder = folder("reader-gone");
    let mut child = command(&folder, "listen -").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut stdin = child.stdin.take().unwrap();
    let hello = Message::Status(Default::default());
    let frame = frames(&[hello]);
    // it goes on until the program has gone, or for longer than a pipe is deep
    let written = (0..1_000_000).map_while(|_| stdin.write_all(&frame).ok()).count();
    assert!(written < 1_000_000);
    assert!(child.wait().unwrap().success());

    // what the rig is to save is saved
    let mut child = command(&folder, "rig --save c.txt").stdout(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    assert!(child.wait().unwrap().success());
    assert!(fs::read_to_string(folder.join("c.txt")).unwrap().starts_with("scanseg capture 1\n"));
}

#[test]
fn a_full_device_is_no_panic() {
    let folder = folder("full-device");
    let Ok(full) = File::options().write(true).open("/dev/full") else { return };
    small_scan(&folder);
    let code = |arguments: &str, stdout: Stdio, stderr: Stdio| {
        command(&folder, arguments).stdout(stdout).stderr(stderr).status().unwrap().code()
    };
    let full = || Stdio::from(full.try_clone().unwrap());
    for failing in ["segment absent --geometry absent --out out", "frob", "", "listen absent"] {
        assert_eq!(code(failing, Stdio::null(), full()), Some(2), "{failing}");
        assert_eq!(code(failing, full(), full()), Some(2), "{failing}");
    }
    for printing in [SEGMENT, "--help", "--version", "rig --scans 1", "bench scan.pgm --geometry geometry.toml"] {
        assert_eq!(code(printing, full(), Stdio::null()), Some(2), "{printing}");
        assert_eq!(code(printing, full(), full()), Some(2), "{printing}");
    }
    // a warning that nobody can read
    fs::write(folder.join("geometry.toml"), GEOMETRY.replace("0.001", "1")).unwrap();
    assert_eq!(code(SEGMENT, Stdio::null(), full()), Some(0));
}

#[test]
fn results_go_through_pipes() {
    let folder = folder("through-pipes");
    pipe(&folder.join("link"));
    let reader = std::thread::spawn({
        let path = folder.join("link");
        move || fs::read(path).unwrap()
    });
    succeeds(&folder, "rig --scans 1 --link link");
    assert!(reader.join().unwrap().len() > 1000);
    assert!(fs::metadata(folder.join("link")).unwrap().file_type().is_fifo());
}

/// Names come from strangers: nothing of them reaches the terminal as a command.
#[test]
fn control_characters_are_escaped_and_long_values_cut() {
    let folder = folder("control");
    small_scan(&folder);
    let said = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_scanseg"));
        let output = command.current_dir(&folder).args(arguments).output().unwrap();
        assert_eq!(output.status.code(), Some(2));
        String::from_utf8(output.stderr).unwrap()
    };
    let long = "k".repeat(1500);
    fs::write(folder.join("key.toml"), format!("{GEOMETRY}\"\\u001b[31m\\u0000\\u0007\\r\" = 1\n")).unwrap();
    fs::write(folder.join("long.toml"), format!("{GEOMETRY}{long} = 1\n")).unwrap();
    fs::write(folder.join("value.toml"), GEOMETRY.replace("pinhole", &"v ".repeat(1000))).unwrap();
    for (geometry, says) in
        [("key.toml", "\\u{1b}[31m\\u{0}\\u{7}\\r"), ("long.toml", "kkk..."), ("value.toml", "v v ...\"")]
    {
        let said = said(&["segment", "scan.pgm", "--geometry", geometry, "--out", "out"]);
        assert!(said.contains(says), "{said}");
        assert!(said.len() < 600 && !said.trim_end_matches('\n').contains(char::is_control), "{said:?}");
    }
    for arguments in [
        &["segment", "a\x1b[2Jb\r\n\x07", "--geometry", "g", "--out", "o"] as &[&str],
        &["listen", "\x1b[2J"],
        &["\x1b[2J"],
        &["segment", "--\x1b[2J"],
        &["rig", "--faults", "\x1b[2J"],
        &["listen", &"x".repeat(4000)],
    ] {
        let said = said(arguments);
        assert!(said.len() < 600 && !said.trim_end_matches('\n').contains(char::is_control), "{said:?}");
    }
}

#[test]
fn another_version_of_the_link_is_said() {
    let folder = folder("other-version");
    for (version, says) in [(VERSION, ""), (VERSION + 6, "version 7 of the link, not 1")] {
        let hello = Message::Hello { version };
        fs::write(folder.join("link.bin"), frames(&[hello, Message::Status(Default::default()), hello])).unwrap();
        let output = scanseg(&folder, "listen link.bin");
        let warned = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && warned.contains(says), "{warned}");
        assert_eq!(warned.lines().count(), usize::from(version != VERSION), "said once: {warned}");
    }
    fs::write(folder.join("capture.txt"), "scanseg capture 2\n").unwrap();
    fails(&folder, "replay capture.txt", &["capture.txt", "version 2", "not 1"]);
}

/// A tall image makes no picture larger than a few of its own.
#[test]
fn pictures_of_tall_images_are_small() {
    let folder = folder("tall");
    let image = GreyImage { rows: 65_535, columns: 1, max_value: 65535, values: vec![2000; 65_535] };
    fs::write(folder.join("scan.pgm"), image.to_pgm()).unwrap();
    fs::write(folder.join("geometry.toml"), GEOMETRY.replace("fy = 30.0", "fy = 30000.0")).unwrap();
    assert!(scanseg(&folder, SEGMENT).status.success());
    let mut head = [0; 24];
    File::open(folder.join("out/overview.png")).unwrap().read_exact(&mut head).unwrap();
    let side = |at: usize| u32::from_be_bytes(head[at..at + 4].try_into().unwrap());
    assert!(u64::from(side(16)) * u64::from(side(20)) < 30_000_000, "{} x {}", side(16), side(20));
}
