//! Recorded captures of lidars against what other programs made of them.

use std::fs;
use std::path::PathBuf;

use scanseg_formats::lidar::{Assembler, Datagrams, FiringRows, Metadata};
use scanseg_formats::{Angles, GreyImage, Kind, ReadOptions, ScanFile};

/// Returns the path of recorded data, or says that a test skips.
fn recorded(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    let there = path.exists();
    if !there {
        println!("skipped: no {}", path.display());
    }
    there.then_some(path)
}

#[test]
fn an_ouster_frame_is_the_range_image_that_its_maker_saved() {
    let Some(capture) = recorded("ouster-os0/OS-0-128-U1_v2.3.0_1024x10.pcap") else { return };
    let Some(image) = recorded("ouster-os0/range.pgm") else { return };
    let Some(json) = recorded("ouster-os0/metadata.json") else { return };
    let metadata = Metadata::parse(&fs::read_to_string(json).unwrap()).unwrap();
    let mut datagrams = Datagrams::new(fs::File::open(&capture).unwrap()).unwrap();
    let mut assembler = Assembler::new(metadata);
    while let Some(datagram) = datagrams.next_datagram().unwrap() {
        assert_eq!(assembler.push(datagram.payload), None);
    }
    let frame = assembler.finish().unwrap();
    let saved = GreyImage::read(image).unwrap();
    assert_eq!((frame.came, frame.range_mm.len()), (1024, saved.values.len()));
    let other = (0..).zip(&frame.range_mm).zip(&saved.values).find(|((_, mm), count)| **mm != 8 * u32::from(**count));
    assert_eq!(other, None);
}

#[test]
fn captures_of_ouster_find_their_metadata_and_their_frames() {
    for (name, frames, rows, measured_percent) in [
        ("ouster-os0/OS-0-128-U1_v2.3.0_1024x10.pcap", 1, 128, 60),
        ("ouster-os1/OS-1-128_v2.3.0_1024x10_lb_n3.pcap", 3, 128, 50),
        ("ouster-os1/OS-1-32-G_v2.1.1_1024x10.pcap", 1, 32, 50),
    ] {
        let Some(path) = recorded(name) else { return };
        let mut file = ScanFile::open(&path, &ReadOptions::default()).unwrap();
        assert_eq!(file.frames(), frames, "{name}");
        // also back to the start
        for n in (0..frames).rev() {
            let scan = file.frame(n).unwrap();
            assert_eq!((scan.image.rows, scan.image.columns), (rows, 1024), "{name}");
            assert!(100 * scan.measured > measured_percent * rows * 1024, "{name}: {}", scan.measured);
            assert_eq!(scan.remarks, Vec::<String>::new());
            assert!(matches!(scan.geometry.kind, Kind::Spinning { wraps: true, .. }));
            scan.geometry.check().unwrap();
        }
    }
}

#[test]
fn each_turn_of_the_recorded_ld06_is_a_row() {
    let Some(path) = recorded("ld06-uart/ld06_example3.bin") else { return };
    let scan = ScanFile::open(&path, &ReadOptions::default()).unwrap().frame(0).unwrap();
    // 863 packets of 12 beams
    let (rows, columns) = (scan.image.rows, scan.image.columns);
    println!("{rows} x {columns}, {} measured, {:?}", scan.measured, scan.remarks);
    assert!((450..=460).contains(&columns) && rows * columns <= 863 * 12 && rows * columns >= 863 * 12 - 2 * 460);
    assert_eq!(scan.remarks.len(), 1);
}

#[test]
fn firings_of_an_ouster_lie_where_the_formula_of_its_maker_says() {
    let Some(capture) = recorded("ouster-os1/OS-1-128_v2.3.0_1024x10_lb_n3.pcap") else { return };
    let Some(json) = recorded("ouster-os1/OS-1-128_v2.3.0_1024x10.json") else { return };
    let metadata = Metadata::parse(&fs::read_to_string(json).unwrap()).unwrap();
    let mut datagrams = Datagrams::new(fs::File::open(&capture).unwrap()).unwrap();
    let mut rows: Option<FiringRows> = None;
    let mut assembler = Assembler::new(metadata.clone());
    let mut frame = None;
    let mut found = vec![];
    while let Some(datagram) = datagrams.next_datagram().unwrap() {
        if datagram.payload.len() != metadata.packet_bytes() || frame.is_some() {
            continue;
        }
        let rows = rows.get_or_insert_with(|| FiringRows::of(datagram.payload, Some(&metadata)).unwrap());
        rows.push(datagram.payload, |row| found.push((row.turn_deg, row.range_m.to_vec())));
        frame = assembler.push(datagram.payload);
    }
    let (frame, mut geometry) = (frame.unwrap(), rows.unwrap().geometry());
    let (mut compared, mut most_m) = (0, 0.0f64);
    // the first rows wait for the rings that look to the left
    for (turn_deg, range_m) in found[24..1024].iter().step_by(7) {
        let Kind::Nodding { turn_deg: turns, .. } = &mut geometry.kind else { panic!() };
        *turns = Angles::Listed(vec![*turn_deg]);
        let Some(Angles::Listed(left_deg)) = geometry.beside.column_offset_deg.clone() else { panic!() };
        for (ring, range_m) in range_m.iter().enumerate().filter(|(_, range_m)| **range_m > 0.0) {
            let (origin, direction) = (geometry.origin(0, ring), geometry.direction(0, ring));
            let point = [0, 1, 2].map(|i| origin[i] + direction[i] * f64::from(*range_m));
            // the column at which the laser looked there
            let azimuth_deg = turn_deg + left_deg[ring] + metadata.azimuth_deg[ring];
            let measured = (-azimuth_deg / 360.0 * 1024.0).round().rem_euclid(1024.0) as usize;
            let to = (measured + metadata.shifts[ring]) % 1024;
            let counted_m = f64::from(frame.range_mm[ring * 1024 + to]) / 1000.0;
            let encoder_rad = -std::f64::consts::TAU * measured as f64 / 1024.0;
            let beam_rad = encoder_rad - metadata.azimuth_deg[ring].to_radians();
            let up_rad = metadata.elevation_deg[ring].to_radians();
            let rest_m = counted_m - metadata.beam_origin_m[0];
            let right = [
                rest_m * beam_rad.cos() * up_rad.cos() + metadata.beam_origin_m[0] * encoder_rad.cos(),
                rest_m * beam_rad.sin() * up_rad.cos() + metadata.beam_origin_m[0] * encoder_rad.sin(),
                rest_m * up_rad.sin(),
            ];
            let off_m = (0..3).map(|i| (point[i] - right[i]).powi(2)).sum::<f64>().sqrt();
            most_m = most_m.max(off_m);
            compared += 1;
        }
    }
    println!("{compared} points, at most {most_m:.4} m apart");
    assert!(compared > 10_000 && most_m < 0.002);
}
