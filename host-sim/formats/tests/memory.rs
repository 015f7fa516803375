//! The memory that files take, whatever they claim: allocations are counted.

use scanseg_formats::{Depth, Geometry, GreyImage, Kind, ReadOptions, ScanFile};

/// The most bytes that were taken at a time.
fn most_bytes(work: impl FnOnce()) -> u64 {
    allocation_counter::measure(work).bytes_max
}

/// A PNG of 16 bits and so many rows of zeros, some thousandth of them long.
fn zeros(rows: u32, columns: u32) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, rows);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::Sixteen);
    encoder.set_compression(png::Compression::High);
    encoder.write_header().unwrap().write_image_data(&vec![0; 2 * (rows * columns) as usize]).unwrap();
    bytes
}

#[test]
fn an_image_that_is_refused_takes_next_to_nothing() {
    let large = zeros(4097, 4096);
    assert!(large.len() < 200_000, "{}", large.len());
    assert!(most_bytes(|| assert!(GreyImage::decode(&large).is_err())) < 500_000);
    let claim = b"P5\n2147483647 2147483647\n65535\n\0";
    assert!(most_bytes(|| assert!(GreyImage::decode(claim).is_err())) < 1000);
}

#[test]
fn an_image_takes_a_few_bytes_for_each_pixel() {
    let image = zeros(500, 800);
    let pixels = 500 * 800;
    assert!(most_bytes(|| assert!(GreyImage::decode(&image).is_ok())) < 6 * pixels);
    let image = GreyImage::decode(&image).unwrap();
    assert!(most_bytes(|| _ = image.to_png()) < 8 * pixels);
    let pgm = image.to_pgm();
    assert!(most_bytes(|| _ = GreyImage::decode(&pgm)) < 3 * pixels);
}

#[test]
fn a_geometry_takes_some_times_its_text() {
    let angles: Vec<String> = (0..60_000).map(|i| i.to_string()).map(|i| format!("0.{i}")).collect();
    let text = format!(
        "version = 1\nunit_m = 0.001\nkind = 'nodding'\nturn_axis = 'y'\nbeam_deg = {{ start = 0, step = 1 }}\nturn_deg = [{}]\n",
        angles.join(", ")
    );
    let most = most_bytes(|| assert!(Geometry::parse(&text).is_ok()));
    assert!(most < 100 * text.len() as u64, "{most} of {}", text.len());
    let keys: String = (0..20_000).map(|i| format!("k{i} = 1\n")).collect();
    let most = most_bytes(|| assert!(Geometry::parse(&keys).is_err()));
    assert!(most < 100 * keys.len() as u64, "{most} of {}", keys.len());
}

/// Headers that claim the most pixels there may be, over nothing.
#[test]
fn a_cloud_that_claims_much_takes_next_to_nothing() {
    let pcd = |data: &str| {
        format!(
            "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 4096\nHEIGHT 4096\nPOINTS 16777216\nDATA {data}\n"
        )
        .into_bytes()
    };
    let packed = [&pcd("binary_compressed")[..], &[8, 0, 0, 0, 0, 0, 0, 12], &[0; 8]].concat();
    let ply = |of: &str, kind: &str| {
        format!(
            "ply\nformat {kind} 1.0\nobj_info num_cols 4096\nobj_info num_rows 4096\nelement vertex {of}\n\
             property float x\nproperty float y\nproperty float z\nelement empty 99999999999\nend_header\n0 0 0\n"
        )
        .into_bytes()
    };
    let shape = "{'descr': '<f4', 'fortran_order': False, 'shape': (4096, 4096, 3)}\n";
    let npy = [b"\x93NUMPY\x01\x00", &(shape.len() as u16).to_le_bytes()[..], shape.as_bytes()].concat();
    // a list of scans of 50 MB, in an E57 of one page
    let mut e57 = vec![0; 1024];
    e57[..8].copy_from_slice(b"ASTM-E57");
    e57[8] = 1;
    e57[16..24].copy_from_slice(&1024u64.to_le_bytes());
    e57[32..40].copy_from_slice(&50_000_000u64.to_le_bytes());
    e57[40..48].copy_from_slice(&1024u64.to_le_bytes());
    let files = [
        pcd("ascii"),
        pcd("binary"),
        packed,
        ply("16777216", "ascii"),
        ply("16777216", "binary_little_endian"),
        npy,
        e57,
    ];
    for (i, bytes) in files.iter().enumerate() {
        let path = crate::clouds::file(&format!("claim{i}"), bytes);
        let most = most_bytes(|| assert!(ScanFile::open(&path, &ReadOptions::default()).is_err()));
        assert!(most < 100_000, "{i}: {most} bytes");
    }
}

#[test]
fn a_cloud_takes_some_times_its_file() {
    let (rows, columns) = (200, 300);
    let kind = Kind::Pinhole { fx_px: 300.0, fy_px: 300.0, cx_px: 150.0, cy_px: 100.0, depth: Depth::Range };
    let points = crate::clouds::points_of(&Geometry::of(kind), rows, columns, |row, column| (row + column) % 5 > 0);
    let shaken: Vec<_> = (0..).zip(&points).map(|(i, p)| [p[0], p[1] + 0.02 * ((i * 37 % 11) as f32), p[2]]).collect();
    let text = |points: &[[f32; 3]]| points.iter().map(|[x, y, z]| format!("{x} {y} {z}")).collect::<Vec<_>>();
    let files = [
        ("binary", crate::clouds::binary_pcd(rows, columns, &points)),
        ("packed", crate::clouds::packed_pcd(rows, columns, &points)),
        ("ascii", crate::clouds::ascii_pcd(rows, columns, &text(&points))),
        ("free", crate::clouds::binary_pcd(rows, columns, &shaken)),
    ];
    for (name, bytes) in files {
        let path = crate::clouds::file(name, &bytes);
        let most = most_bytes(|| assert!(ScanFile::open(&path, &ReadOptions::default()).is_ok()));
        println!("{name}: {:.1} times its file", most as f64 / bytes.len() as f64);
        assert!(most < 12 * bytes.len() as u64, "{name}: {most} of {}", bytes.len());
    }
}
