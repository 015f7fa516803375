//! Files that come from elsewhere: an error, or what is written again the same; never more memory
//! than in proportion.
#![no_main]

use libfuzzer_sys::fuzz_target;
use scanseg_formats::{Capture, Geometry, GreyImage, RangeImage};

fuzz_target!(|data: &[u8]| {
    let Some((&kind, data)) = data.split_first() else { return };
    match kind % 4 {
        0 => image(data, None),
        1 => {
            let (Some(geometry), rest) = first_text(data) else { return };
            let Ok(geometry) = Geometry::parse(geometry) else { return };
            let written = geometry.to_toml();
            assert_eq!(Geometry::parse(&written).as_ref(), Ok(&geometry), "{written}");
            image(rest, Some(&geometry));
        }
        2 => {
            let Ok(text) = str::from_utf8(data) else { return };
            let Ok(capture) = Capture::parse(text) else { return };
            let written = capture.to_text();
            // NaN is not equal to itself, but is written the same
            assert_eq!(Capture::parse(&written).map(|capture| capture.to_text()), Ok(written));
        }
        _ => {
            let (Some(geometry), raw) = first_text(data) else { return };
            let Ok(geometry) = Geometry::parse(geometry) else { return };
            for range_bits in 12..=17 {
                let Ok((capture, _)) = Capture::of_telegrams(raw, &geometry, range_bits) else { continue };
                let written = capture.to_text();
                assert_eq!(Capture::parse(&written).map(|capture| capture.to_text()), Ok(written));
            }
        }
    }
});

/// The text up to a zero, and what follows.
fn first_text(data: &[u8]) -> (Option<&str>, &[u8]) {
    let length = data.iter().position(|&byte| byte == 0).unwrap_or(data.len());
    (str::from_utf8(&data[..length]).ok(), data.get(length + 1..).unwrap_or(&[]))
}

fn image(data: &[u8], geometry: Option<&Geometry>) {
    let Ok(image) = GreyImage::decode(data) else { return };
    assert!(image.rows > 0 && image.columns > 0 && image.values.len() == image.rows * image.columns);
    assert_eq!(GreyImage::decode(&image.to_pgm()).as_ref(), Ok(&image));
    let png = GreyImage::decode(&image.to_png()).expect("a PNG of ours");
    assert_eq!((png.rows, png.columns, &png.values), (image.rows, image.columns, &image.values));
    let Some(geometry) = geometry else { return };
    let Ok(ranges) = RangeImage::from_grey(&image, geometry) else { return };
    assert!(ranges.range_m.iter().all(|range_m| range_m.is_finite() && *range_m >= 0.0));
    _ = ranges.to_grey(geometry);
}
