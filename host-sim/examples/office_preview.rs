//! Pictures of the simulated office: `office_preview FOLDER` writes one PNG per scene, the range
//! above and the surfaces below, left being left.

use scanseg_sim::office::{SCENES, Scene, Sensor, Set};
use std::{env, error::Error, fs::File, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = env::args().nth(1).ok_or("usage: office_preview FOLDER")?;
    let sensor = Sensor::nodding(200, 361);
    for (set, name) in [(Set::Tuning, "tuning"), (Set::Validation, "validation")] {
        let mut total = 0;
        for number in 0..SCENES {
            let scan = Scene::numbered(set, number).scan(&sensor, 0)?;
            let mut pixels = vec![0; usize::from(u16::MAX) + 1];
            scan.truth.iter().for_each(|&id| pixels[usize::from(id)] += 1);
            let regions = pixels[1..].iter().filter(|&&n| n >= 30).count();
            total += regions;
            println!("{name} {number:2}: {regions} regions of 30 pixels or more, {} without return", pixels[0]);

            let mut picture = Vec::new();
            // The nearest 8 m as grey, then a colour per id.
            for (i, row) in scan.range_m.chunks(scan.columns).chain(scan.range_m.chunks(scan.columns)).enumerate() {
                for column in (0..scan.columns).rev() {
                    if i < scan.rows {
                        picture.extend([(row[column] * 32.0).min(255.0) as u8; 3]);
                    } else {
                        let id = u32::from(scan.truth[(i - scan.rows) * scan.columns + column]);
                        let mixed = id.wrapping_mul(2_654_435_761);
                        picture.extend([24, 16, 8].map(|s| if id == 0 { 0 } else { (mixed >> s) as u8 | 32 }));
                    }
                }
            }
            let file = File::create(Path::new(&folder).join(format!("{name}-{number:02}.png")))?;
            let mut encoder = png::Encoder::new(file, scan.columns as u32, 2 * scan.rows as u32);
            encoder.set_color(png::ColorType::Rgb);
            encoder.write_header()?.write_image_data(&picture)?;
        }
        println!("{name}: {total} regions in all");
    }
    Ok(())
}
