//! Grey and range images: what is refused and how it is said, round trips, the recorded scans.
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use scanseg_formats::{Geometry, GreyImage, RangeImage, read_at_most, write_all_or_none, write_atomic};

fn message(bytes: &[u8]) -> String {
    let message = GreyImage::decode(bytes).unwrap_err().to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

#[test]
fn pgm_headers_may_hold_comments_and_any_white_space() {
    let bytes =
        b"P5 # made by hand\n#\n\t2#columns\r3 \n# largest\n 300\n\x00\x01\x00\x02\x00\x03\x00\x04\x00\x05\x01\x2c";
    let image = GreyImage { rows: 3, columns: 2, max_value: 300, values: vec![1, 2, 3, 4, 5, 300] };
    assert_eq!(GreyImage::decode(bytes), Ok(image));
    let narrow = GreyImage { rows: 1, columns: 2, max_value: 255, values: vec![7, 255] };
    assert_eq!(GreyImage::decode(b"P5\n2 1\n255\n\x07\xff"), Ok(narrow));
}

#[test]
fn a_malformed_pgm_is_refused_in_one_line() {
    let cases: [(&[u8], &str); 16] = [
        (b"", "neither a PGM (P5) nor a PNG file"),
        (b"P", "neither a PGM (P5) nor a PNG file"),
        (b"P2\n1 1\n255\n7", "a P2 file; only P5 (binary PGM) and PNG are read"),
        (b"P5", "PGM header: no width at byte 2"),
        (b"P52 1\n255\n\x07\xff", "PGM header: no width at byte 2"),
        (b"P5\nwide", "PGM header: no width at byte 3"),
        (b"P5\n-2 1\n255\n", "PGM header: no width at byte 3"),
        (b"P5\n2 #1\n", "PGM header: no height at byte 8"),
        (b"P5\n2 1\n", "PGM header: no largest value at byte 7"),
        (b"P5\n2 1\n255", "PGM header: no white space after the largest value at byte 10"),
        (b"P5\n0 1\n255\n", "PGM header: width at byte 3 is not from 1 to 2147483647"),
        (b"P5\n99999999999 1\n255\n", "PGM header: width at byte 3 is not from 1 to 2147483647"),
        (b"P5\n1 1\n65536\n\x00\x00", "PGM header: largest value at byte 7 is not from 1 to 65535"),
        (b"P5\n2 2\n256\n\0\0\0\0\0", "PGM of 2 x 2 needs 8 bytes of values, the file has 5: 1 whole rows"),
        (b"P5\n2 1\n255\n\x07\xff\n", "1 bytes too many after the image"),
        (b"P5\n2 2\n9\n\x00\x09\x00\x0a", "PGM value 10 in row 1, column 1 is above the header's 9"),
    ];
    for (bytes, expected) in cases {
        assert_eq!(message(bytes), expected);
    }
}

#[test]
fn a_claimed_size_is_not_believed() {
    assert_eq!(
        message(b"P5\n4096 4096\n65535\n\x00"),
        "PGM of 4096 x 4096 needs 33554432 bytes of values, the file has 1: 0 whole rows"
    );
    let claim = png_of(png::ColorType::Grayscale, png::BitDepth::Sixteen, 4096, 4096, None);
    let said = message(&claim);
    assert!(said.starts_with("PNG claims 4096 x 4096 pixels, more than a file of"), "{said}");
}

/// The header tells how many pixels there are, before any is decoded: a PNG of so many zeros is
/// short.
#[test]
fn images_of_too_many_pixels_are_refused_by_their_header() {
    for (rows, columns) in [(4097_u64, 4096), (32_000, 32_000), (1, 0x7fff_ffff), (0x7fff_ffff, 0x7fff_ffff)] {
        let says = format!("{rows} rows x {columns} columns are {} pixels, the most are 16777216", rows * columns);
        assert_eq!(message(format!("P5\n{columns} {rows}\n65535\n").as_bytes()), says);
        let png = png_of(png::ColorType::Grayscale, png::BitDepth::Sixteen, columns as u32, rows as u32, None);
        assert_eq!(message(&png), says);
    }
    assert_eq!(GreyImage::decode(b"P5\n1 1\n1\n\x01").unwrap().values, [1]);
}

/// A device without an end is not read to it.
#[test]
fn what_never_ends_is_not_read() {
    let zeros = Path::new("/dev/zero");
    if !zeros.exists() {
        return skipped(zeros);
    }
    let said = GreyImage::read(zeros).unwrap_err().to_string();
    assert_eq!(said, "/dev/zero: more than 64 MiB, longer than any image of 16777216 pixels");
    let said = Geometry::read(zeros).unwrap_err().to_string();
    assert_eq!(said, "/dev/zero: more than 16 MiB, the most that is read");
    assert_eq!(read_at_most(zeros, 0).unwrap_err().kind(), io::ErrorKind::FileTooLarge);
    // the header of a stream that goes on
    let folder = fresh_directory("never_ends");
    let long = folder.join("long.pgm");
    let mut file = fs::File::create(&long).unwrap();
    file.write_all(b"P5\n60000 60000\n65535\n").unwrap();
    file.set_len(7_200_000_000).unwrap();
    let said = GreyImage::read(&long).unwrap_err().to_string();
    assert!(said.ends_with("60000 rows x 60000 columns are 3600000000 pixels, the most are 16777216"), "{said}");
    fs::remove_file(long).unwrap();
}

/// A PNG, without rows where there is no data.
fn png_of(colour: png::ColorType, depth: png::BitDepth, width: u32, height: u32, data: Option<&[u8]>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if colour == png::ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 255, 255, 255]);
    }
    let mut writer = encoder.write_header().unwrap();
    match data {
        Some(data) => writer.write_image_data(data).unwrap(),
        None => writer.write_chunk(png::chunk::IDAT, &[0; 4]).unwrap(),
    }
    drop(writer);
    bytes
}

#[test]
fn png_of_other_kinds_is_refused() {
    use png::{BitDepth, ColorType};
    for (colour, depth, data, found) in [
        (ColorType::Grayscale, BitDepth::One, 1, "Grayscale, 1 bits"),
        (ColorType::Grayscale, BitDepth::Four, 1, "Grayscale, 4 bits"),
        (ColorType::GrayscaleAlpha, BitDepth::Eight, 2, "GrayscaleAlpha, 8 bits"),
        (ColorType::Rgb, BitDepth::Sixteen, 6, "Rgb, 16 bits"),
        (ColorType::Rgba, BitDepth::Eight, 4, "Rgba, 8 bits"),
        (ColorType::Indexed, BitDepth::Eight, 1, "Indexed, 8 bits"),
    ] {
        let bytes = png_of(colour, depth, 1, 1, Some(&vec![0; data]));
        assert_eq!(message(&bytes), format!("PNG is not plain grey of 8 or 16 bits: {found}"));
    }
    let mut keyed = Vec::new();
    let mut encoder = png::Encoder::new(&mut keyed, 1, 1);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_trns(vec![0, 9]);
    encoder.write_header().unwrap().write_image_data(&[3]).unwrap();
    assert_eq!(message(&keyed), "PNG is not plain grey of 8 or 16 bits: Grayscale, 8 bits, transparent or animated");
}

fn sample() -> GreyImage {
    GreyImage { rows: 5, columns: 7, max_value: 65535, values: (0..35).map(|i| i * 1817 % 65521).collect() }
}

#[test]
fn a_png_cut_anywhere_is_refused() {
    let bytes = sample().to_png();
    assert_eq!(GreyImage::decode(&bytes), Ok(sample()));
    for end in 8..bytes.len() {
        let said = message(&bytes[..end]);
        assert!(said.starts_with("PNG damaged at or before byte "), "cut at {end}: {said}");
    }
    let longer = [&bytes[..], b"junk"].concat();
    assert_eq!(message(&longer), "4 bytes too many after the image");
}

#[test]
fn a_png_with_a_changed_bit_is_refused() {
    let bytes = sample().to_png();
    for i in 0..bytes.len() * 8 {
        let mut changed = bytes.clone();
        changed[i / 8] ^= 1 << (i % 8);
        // A changed chunk may be skipped as one of an unknown kind, but never read as other pixels.
        match GreyImage::decode(&changed) {
            Ok(image) => assert_eq!(image, sample(), "bit {i}"),
            Err(e) => assert!(!e.to_string().contains('\n')),
        }
    }
}

#[test]
fn counts_become_ranges() {
    let toml = "version = 1
unit_m = 0.01
no_return = [500]
min_range_m = 0.21
max_range_m = 7.0
kind = 'spinning'
azimuth_deg = { start = 0, step = 1 }
elevation_deg = { start = 0, step = 1 }
";
    let geometry = Geometry::parse(toml).unwrap();
    let image = GreyImage { rows: 2, columns: 4, max_value: 65535, values: vec![0, 20, 21, 500, 501, 700, 701, 65535] };
    let ranges = RangeImage::from_grey(&image, &geometry).unwrap();
    assert_eq!((ranges.rows, ranges.columns), (2, 4));
    assert_eq!(ranges.range_m, [0.0, 0.0, 0.21, 0.0, 5.01, 7.0, 0.0, 0.0]);
    assert_eq!(ranges.to_grey(&geometry).unwrap().values, [0, 0, 21, 0, 501, 700, 0, 0]);

    let listed = Geometry::parse(&toml.replace("elevation_deg = { start = 0, step = 1 }", "elevation_deg = [1]"));
    let listed = listed.unwrap();
    let said = "`elevation_deg` lists 1 angles, the image has 2 rows";
    assert_eq!(RangeImage::from_grey(&image, &listed).unwrap_err().to_string(), said);
    assert_eq!(ranges.to_grey(&listed).unwrap_err().to_string(), said);
}

#[test]
fn camera_depth_becomes_range_along_the_beam() {
    let toml = "version = 1
unit_m = 0.001
max_range_m = 1.0
kind = 'pinhole'
depth = 'z'
fx = 1
fy = 1
cx = 0
cy = 0
";
    let image = GreyImage { rows: 3, columns: 3, max_value: 65535, values: vec![1000, 1000, 0, 0, 0, 0, 0, 0, 1000] };
    let camera = Geometry::parse(toml).unwrap();
    let ranges = RangeImage::from_grey(&image, &camera).unwrap();
    // |(1, u, v)| at (0, 0), (0, 1), (2, 2); the limit applies to the depth, which is 1 m everywhere.
    let expected = [(0, 1.0), (1, 2f32.sqrt()), (8, 3.0)];
    for (i, range_m) in expected {
        assert!((ranges.range_m[i] - range_m).abs() < 1e-6, "{i}: {}", ranges.range_m[i]);
    }
    assert_eq!(ranges.to_grey(&camera).unwrap(), image);

    let along_beam = Geometry::parse(&toml.replace("'z'", "'range'")).unwrap();
    assert_eq!(RangeImage::from_grey(&image, &along_beam).unwrap().range_m[8], 1.0);
}

#[test]
fn ranges_beyond_the_counts_are_refused_and_no_ranges_become_0() {
    let toml = "version = 1
unit_m = 0.001
kind = 'spinning'
azimuth_deg = { start = 0, step = 1 }
elevation_deg = { start = 0, step = 1 }
";
    let geometry = Geometry::parse(toml).unwrap();
    let image = |range_m: Vec<f32>| RangeImage { rows: 1, columns: range_m.len(), range_m };
    let none = image(vec![0.0, -1.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0004, 0.0006, 65.535]);
    assert_eq!(none.to_grey(&geometry).unwrap().values, [0, 0, 0, 0, 0, 0, 1, 65535]);
    assert_eq!(
        image(vec![1.0, 65.536]).to_grey(&geometry).unwrap_err().to_string(),
        "the range 65.536 m of row 0, column 1 is more than 65535 counts of 0.001 m"
    );
}

/// An empty directory of this test alone.
fn fresh_directory(name: &str) -> PathBuf {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir_all(&directory).unwrap();
    directory
}

fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn files_are_written_all_or_none() {
    let directory = fresh_directory("all_or_none");
    let (a, b) = (directory.join("a.pgm"), directory.join("b.toml"));
    write_atomic(&a, b"old").unwrap();
    let nowhere = directory.join("none/c");
    let e = write_all_or_none(&[(&a, b"new"), (&b, b"new"), (&nowhere, b"new")]).unwrap_err();
    assert!(e.to_string().starts_with(&format!("{}: ", nowhere.display())), "{e}");
    assert_eq!(names(&directory), ["a.pgm"]);
    assert_eq!(fs::read(&a).unwrap(), b"old");

    write_all_or_none(&[(&a, b"new"), (&b, b"too")]).unwrap();
    assert_eq!(names(&directory), ["a.pgm", "b.toml"]);
    assert_eq!((fs::read(&a).unwrap(), fs::read(&b).unwrap()), (b"new".to_vec(), b"too".to_vec()));

    // A directory in the place of a target is seen before anything is written.
    let taken = directory.join("taken");
    fs::create_dir(&taken).unwrap();
    let e = write_all_or_none(&[(&a, b"newer"), (&b, b"newer"), (&taken, b"new")]).unwrap_err();
    assert!(e.to_string().starts_with(&format!("{}: ", taken.display())), "{e}");
    assert_eq!((fs::read(&a).unwrap(), fs::read(&b).unwrap()), (b"new".to_vec(), b"too".to_vec()));
    assert!(write_atomic("..", b"new").is_err());
    assert_eq!(names(&directory), ["a.pgm", "b.toml", "taken"]);
}

/// What is no plain file stays what it is, and gets the bytes.
#[cfg(unix)]
#[test]
fn links_pipes_and_devices_are_written_through() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let directory = fresh_directory("through");
    let [link, file, dangling, made] = ["link", "file", "dangling", "made"].map(|name| directory.join(name));
    fs::write(&file, b"old").unwrap();
    symlink("file", &link).unwrap();
    symlink("made", &dangling).unwrap();
    write_all_or_none(&[(&link, b"new"), (&dangling, b"first")]).unwrap();
    assert!([&link, &dangling].iter().all(|path| fs::symlink_metadata(path).unwrap().is_symlink()));
    assert_eq!((fs::read(&file).unwrap(), fs::read(&made).unwrap()), (b"new".to_vec(), b"first".to_vec()));
    assert_eq!(names(&directory), ["dangling", "file", "link", "made"]);

    let pipe = directory.join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).unwrap()
    });
    write_atomic(&pipe, b"through").unwrap();
    assert_eq!(reader.join().unwrap(), b"through");
    assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());

    write_atomic("/dev/null", b"gone").unwrap();
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    if Path::new("/dev/full").exists() {
        // nothing else is new if a stream takes nothing
        assert!(write_all_or_none(&[(&file, b"newer"), (Path::new("/dev/full"), b"x")]).is_err());
        assert_eq!(fs::read(&file).unwrap(), b"new");
        assert!(fs::metadata("/dev/full").unwrap().file_type().is_char_device());
    }
    assert_eq!(names(&directory), ["dangling", "file", "link", "made", "pipe"]);
}

fn images() -> impl Strategy<Value = GreyImage> {
    (1usize..12, 1usize..12, 1u16..).prop_flat_map(|(rows, columns, max_value)| {
        prop::collection::vec(0..=max_value, rows * columns).prop_map(move |values| GreyImage {
            rows,
            columns,
            max_value,
            values,
        })
    })
}

proptest! {
    #[test]
    fn an_image_survives_pgm(image in images()) {
        prop_assert_eq!(GreyImage::decode(&image.to_pgm()), Ok(image));
    }

    #[test]
    fn an_image_survives_png(mut image in images(), narrow in any::<bool>()) {
        if narrow {
            image.values.iter_mut().for_each(|v| *v &= 255);
        }
        image.max_value = if narrow { 255 } else { 65535 };
        prop_assert_eq!(GreyImage::decode(&image.to_png()), Ok(image));
    }

    #[test]
    fn a_pgm_cut_anywhere_is_refused(image in images(), cut in any::<prop::sample::Index>()) {
        let bytes = image.to_pgm();
        prop_assert!(GreyImage::decode(&bytes[..cut.index(bytes.len())]).is_err());
    }

    #[test]
    fn no_bytes_panic(bytes in any::<Vec<u8>>(), start in 0usize..3) {
        let start: &[u8] = [b"P5\n" as &[u8], b"P5 3 2 255\n", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"][start];
        if let Err(e) = GreyImage::decode(&[start, &bytes].concat()) {
            prop_assert!(!e.to_string().contains('\n'));
        }
    }

    #[test]
    fn every_count_survives_its_range(count in 1u16.., unit_m in 1e-5..1.0f64) {
        let geometry = format!(
            "version = 1\nunit_m = {unit_m:?}\nkind = 'pinhole'\ndepth = 'z'\nfx = 300\nfy = 310\ncx = 3\ncy = -200\n"
        );
        let geometry = Geometry::parse(&geometry).unwrap();
        let image = GreyImage { rows: 1, columns: 2, max_value: 65535, values: vec![count, count] };
        let ranges = RangeImage::from_grey(&image, &geometry).unwrap();
        prop_assert_eq!(ranges.to_grey(&geometry), Ok(image));
    }
}

/// Says so even if the output of tests is captured.
fn skipped(path: &Path) {
    _ = writeln!(io::stderr(), "skipped: {} is absent", path.display());
}

#[test]
fn recorded_scans_are_read() {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data"));
    // Set, geometry, images that it fits, rows, columns.
    let laser = ["laserscan-depth.png", "laserscan-bearing-horizontal-ref.png"];
    let camera = [
        "pinhole-depth.png",
        "pinhole-range.png",
        "pinhole-bearing-diagonal-ref.png",
        "pinhole-bearing-vertical-ref.png",
    ];
    let corridor = ["scan000.range_mm.pgm", "scan001.range_mm.pgm", "scan000.planes.pgm", "scan001.planes.pgm"];
    let sets: [(&str, &str, &[&str], usize, usize); 7] = [
        ("tilting-sick-corridor", "geometry.toml", &corridor, 226, 360),
        ("office-room-scan", "geometry.toml", &["room_scan1.range_mm.pgm"], 317, 181),
        ("synpeb", "test_100.geometry.toml", &["test_100.range_100um.pgm", "test_100.gt_labels.pgm"], 100, 100),
        ("bearing-angle-reference", "laserscan.geometry.toml", &laser, 397, 1799),
        ("bearing-angle-reference", "pinhole.geometry.toml", &camera, 540, 960),
        ("ouster-os0", "geometry.toml", &["range.pgm"], 128, 1024),
        ("office1-kinect", "geometry.toml", &["office1.depth_mm.pgm"], 480, 640),
    ];
    for (set, geometry, images, rows, columns) in sets {
        if !data.join(set).is_dir() {
            skipped(&data.join(set));
            continue;
        }
        let geometry = Geometry::read(data.join(set).join(geometry)).unwrap();
        assert_eq!(geometry.fits(rows, columns), Ok(()), "{set}");
        assert_eq!(Geometry::parse(&geometry.to_toml()), Ok(geometry.clone()), "{set}");
        for name in images {
            let image = GreyImage::read(data.join(set).join(name)).unwrap();
            assert_eq!((image.rows, image.columns), (rows, columns), "{set}/{name}");
        }
        let image = GreyImage::read(data.join(set).join(images[0])).unwrap();
        let ranges = RangeImage::from_grey(&image, &geometry).unwrap();
        let returns = ranges.range_m.iter().filter(|m| **m > 0.0).count();
        assert!(returns * 3 > rows * columns, "{set}: {returns} returns");
        let back = ranges.to_grey(&geometry).unwrap();
        for (i, (count, range_m)) in back.values.iter().zip(&ranges.range_m).enumerate() {
            assert_eq!(*count, if *range_m > 0.0 { image.values[i] } else { 0 }, "{set}: pixel {i}");
        }
    }
}
