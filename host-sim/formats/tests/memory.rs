//! The memory that files take, whatever they claim: allocations are counted.

use scanseg_formats::{Geometry, GreyImage};

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
