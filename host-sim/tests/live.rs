//! `scanseg live`: packets on loopback, bytes of a serial line.
#![cfg(unix)]

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::UdpSocket;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use scanseg_core::{Approach, PlaneConfig};
use scanseg_formats::lidar::{Assembler, Datagrams, FiringRows, read_metadata};
use scanseg_formats::{Angles, Kind, RangeImage};
use scanseg_sim::segmentation::{Segmentation, ranging_of};

use crate::program::{fails, folder};
use crate::recorded::recorded;

/// The program, listening, and where it listens.
fn listen(folder: &Path, arguments: &str) -> (Child, BufReader<ChildStdout>, UdpSocket) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_scanseg"));
    command.current_dir(folder).args(["live", "udp:127.0.0.1:0"]).args(arguments.split_whitespace());
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    let mut first = String::new();
    lines.read_line(&mut first).unwrap();
    let address = first.trim().strip_prefix("listening on ").unwrap().to_string();
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(address).unwrap();
    (child, lines, socket)
}

/// A packet of a VLP-16 in the middle of a room of 4 m x 4 m, its first firing at so many hundredths of
/// a degree. Blocks are 0.4 degrees apart.
fn packet_in_a_room(azimuth: u32) -> Vec<u8> {
    let mut bytes = vec![];
    for block in 0..12u32 {
        let at = azimuth + 40 * block;
        bytes.extend([0xFF, 0xEE]);
        bytes.extend(((at % 36000) as u16).to_le_bytes());
        for channel in 0..32u32 {
            let (firing, laser) = (channel / 16, channel % 16);
            let fired = (f64::from(firing) * 55.296 + f64::from(laser) * 2.304) / 110.592;
            let right_rad = ((f64::from(at) + 40.0 * fired) / 100.0).to_radians();
            let up_deg = if laser % 2 == 0 { f64::from(laser) - 15.0 } else { f64::from(laser) };
            let out_m = 2.0 / right_rad.cos().abs().max(right_rad.sin().abs());
            bytes.extend(((out_m / up_deg.to_radians().cos() / 0.002).round() as u16).to_le_bytes());
            bytes.push(100);
        }
    }
    bytes.extend([0, 0, 0, 0, 0x37, 0x22]);
    bytes
}

/// The numbers of a line of a turn: rows, planes, lost rows.
fn numbers(line: &str) -> [usize; 3] {
    let before = |word: &str| {
        let words: Vec<&str> = line.split([' ', ',', ';']).filter(|word| !word.is_empty()).collect();
        let at = words.iter().rposition(|other| *other == word).unwrap();
        words[at - 1].parse().unwrap_or_else(|_| panic!("{line}"))
    };
    let lost: usize = line.split("lost ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let rows = line.split(": ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    [rows, before("planes"), lost]
}

/// The segments of a turn in a file: pixels, distance.
fn segments(path: &Path, turn: usize) -> Vec<(usize, f64)> {
    let text = fs::read_to_string(path).unwrap();
    assert!(text.ends_with('\n'), "a line is not whole");
    let mut found = vec![];
    for line in text.lines().skip(1) {
        let fields: Vec<f64> = line.split(',').map(|field| field.parse().unwrap()).collect();
        assert_eq!(fields.len(), 9, "{line}");
        if fields[0] as usize == turn {
            found.push((fields[1] as usize, fields[2]));
        }
    }
    found
}

#[test]
fn the_walls_of_a_room_come_turn_by_turn() {
    let folder = folder("live-room");
    let (mut child, lines, socket) = listen(&folder, "--turns 3 --out live.csv");
    // begins a third of a turn after 0
    for i in 25..4 * 75 + 2 {
        _ = socket.send(&packet_in_a_room(i * 480));
        sleep(Duration::from_micros(300));
    }
    assert!(child.wait().unwrap().success());
    let lines: Vec<String> = lines.lines().map(Result::unwrap).collect();
    assert_eq!(lines.len(), 3, "{lines:?}");
    let mut lost_before = 0;
    for (turn, line) in lines.iter().enumerate() {
        let [rows, found, lost] = numbers(line);
        // what is lost on the way is counted
        let expected = if turn == 0 { 50 * 24 } else { 75 * 24 };
        assert_eq!(rows + lost - lost_before, expected, "{line}");
        assert!(found >= 4 && line.contains(", 0 strange"), "{line}");
        lost_before = lost;
    }
    if lost_before == 0 {
        for turn in [1, 2] {
            let walls = segments(&folder.join("live.csv"), turn);
            let whole = walls.iter().filter(|(pixels, distance_m)| *pixels > 6000 && (distance_m - 2.0).abs() < 0.01);
            assert_eq!(whole.count(), 4, "{walls:?}");
        }
    }
}

#[test]
fn a_signal_ends_it_with_what_has_come() {
    let folder = folder("live-signal");
    let (mut child, mut lines, socket) = listen(&folder, "--out live.csv");
    for i in 0..110 {
        _ = socket.send(&packet_in_a_room(i * 480));
        sleep(Duration::from_micros(300));
    }
    // the first turn has come
    let mut first = String::new();
    lines.read_line(&mut first).unwrap();
    assert!(first.starts_with("turn 0: "), "{first}");
    let status = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(status.success());
    assert!(child.wait().unwrap().success());
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    assert!(rest.starts_with("turn 1: ") && rest.lines().count() == 1, "{rest}");
    assert!(!segments(&folder.join("live.csv"), 1).is_empty());
}

#[test]
fn a_recorded_ouster_is_replayed() {
    let Some(data) = recorded("ouster-os1") else { return };
    let folder = folder("live-ouster");
    let metadata = data.join("OS-1-128_v2.3.0_1024x10.json");
    let (mut child, lines, socket) = listen(&folder, &format!("--geometry {} --out live.csv", metadata.display()));
    let file = File::open(data.join("OS-1-128_v2.3.0_1024x10_lb_n3.pcap")).unwrap();
    let mut datagrams = Datagrams::new(file).unwrap();
    while let Some(datagram) = datagrams.next_datagram().unwrap() {
        _ = socket.send(datagram.payload);
        sleep(Duration::from_millis(2));
    }
    sleep(Duration::from_millis(500));
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert!(child.wait().unwrap().success());
    let lines: Vec<String> = lines.lines().map(Result::unwrap).collect();
    println!("{lines:#?}");
    assert_eq!(lines.len(), 3, "{lines:?}");
    let of_all = lines.iter().map(|line| numbers(line)[0]).sum::<usize>() + numbers(&lines[2])[2];
    assert_eq!(of_all, 3 * 1024);
    assert!(lines.iter().all(|line| numbers(line)[1] > 50));
}

/// Firings as rows find as much as the image of the turn, in which rings are rows.
#[test]
fn turns_of_an_ouster_have_as_much_on_planes_as_their_images() {
    let Some(data) = recorded("ouster-os1").zip(recorded("ouster-os0")) else { return };
    for (capture, metadata) in [
        (data.0.join("OS-1-128_v2.3.0_1024x10_lb_n3.pcap"), data.0.join("OS-1-128_v2.3.0_1024x10.json")),
        (data.1.join("OS-0-128-U1_v2.3.0_1024x10.pcap"), data.1.join("metadata.json")),
    ] {
        let metadata = read_metadata(&metadata).unwrap();
        let (mut assembler, mut rows, mut image) = (Assembler::new(metadata.clone()), None, None);
        let (mut turn_deg, mut range_m, mut turns) = (vec![], vec![], 0);
        let mut datagrams = Datagrams::new(File::open(capture).unwrap()).unwrap();
        while let Some(datagram) = datagrams.next_datagram().unwrap() {
            image = image.or(assembler.push(datagram.payload));
            if rows.is_none() {
                rows = FiringRows::of(datagram.payload, Some(&metadata)).ok();
            }
            let Some(rows) = &mut rows else { continue };
            rows.push(datagram.payload, |row| {
                turns += usize::from(row.begins_turn);
                if turns == 1 {
                    turn_deg.push(row.turn_deg);
                    range_m.extend_from_slice(row.range_m);
                }
            });
        }
        let rows = rows.unwrap();
        let mut geometry = rows.geometry();
        if let Kind::Nodding { turn_deg: turns, .. } = &mut geometry.kind {
            *turns = Angles::Listed(turn_deg);
        }
        let firings = RangeImage { rows: range_m.len() / rows.columns(), columns: rows.columns(), range_m };
        let (image, of_image) = metadata.image(&image.or(assembler.finish()).unwrap());
        let [live, file] = [(&firings, &geometry, true), (&image, &of_image, false)].map(|(image, geometry, round)| {
            let config = PlaneConfig::new(ranging_of(geometry, Approach::Plane));
            let config = if round { config.with_full_turns() } else { config };
            let found = Segmentation::of(image, geometry, config, None, || ()).unwrap();
            let on_planes = found.of_pixels(30).iter().filter(|segment| segment.plane().is_some());
            on_planes.map(|segment| segment.pixels()).sum::<u32>()
        });
        println!("on planes: {live} of firings, {file} of the image");
        assert!(f64::from(live) > 0.95 * f64::from(file), "{live} {file}");
    }
}

#[test]
fn bytes_of_an_ld06_are_rows() {
    let Some(data) = recorded("ld06-uart") else { return };
    let folder = folder("live-ld06");
    let mut command = Command::new(env!("CARGO_BIN_EXE_scanseg"));
    command.current_dir(&folder).args(["live", "-", "--out", "live.csv"]).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    for piece in fs::read(data.join("ld06_example3.bin")).unwrap().chunks(100) {
        stdin.write_all(piece).unwrap();
    }
    drop(stdin);
    let out = child.wait_with_output().unwrap();
    assert!(out.status.success());
    let said = String::from_utf8(out.stdout).unwrap();
    assert!(said.contains("turn 0: 22 rows") && said.contains("lost 0 packets"), "{said}");
    assert!(segments(&folder.join("live.csv"), 0).len() > 10);
}

#[test]
fn what_cannot_be_listened_to_is_said() {
    let folder = folder("live-refused");
    fails(&folder, "live udp:none", &["udp:none"]);
    fails(&folder, "live /dev/none", &["/dev/none"]);
    fails(&folder, "live /dev/null", &["no turn of an LD06 came"]);
    fails(&folder, "live udp:127.0.0.1:0 --geometry none.json", &["none.json"]);
}
