//! Organised clouds, arrays and files of cameras: an error, or scans that fit their geometry; never
//! more memory than in proportion.
#![no_main]

use std::fs;
use std::sync::LazyLock;

use e57::{E57Writer, Record, RecordDataType, RecordName, RecordValue};
use libfuzzer_sys::fuzz_target;
use scanseg_formats::{GreyImage, ReadOptions};
use scanseg_fuzz::scan_file;

fuzz_target!(|data: &[u8]| {
    let Some((&kind, data)) = data.split_first() else { return };
    let options = ReadOptions::default();
    match kind % 7 {
        // whatever it is
        0 => scan_file::read(data, &options),
        1 => scan_file::read(&organised(data, false), &options),
        2 => scan_file::read(&organised(data, true), &options),
        3 => scan_file::read(&array(data), &options),
        4 => {
            let image = GreyImage { rows: 2, columns: 3, max_value: 65535, values: vec![1000; 6] };
            let path = scan_file::path("camera");
            fs::write(&path, data).expect("a file");
            scan_file::read(&image.to_png(), &ReadOptions { geometry: Some(path), ..options });
        }
        5 => scan_file::read(&patched(data), &options),
        _ => scan_file::read(&listed(data), &options),
    }
});

/// A PCD of small numbers in rows and columns, packed or not: columns, then a byte for each coordinate.
fn organised(data: &[u8], packed: bool) -> Vec<u8> {
    let Some((&columns, data)) = data.split_first() else { return vec![] };
    let columns = usize::from(columns % 40) + 1;
    let rows = data.len() / 3 / columns;
    let form = if packed { "binary_compressed" } else { "binary" };
    let mut bytes = format!(
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH {columns}\nHEIGHT {rows}\nPOINTS {}\nDATA {form}\n",
        rows * columns
    )
    .into_bytes();
    if packed {
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend((12 * (rows * columns) as u32).to_le_bytes());
        bytes.extend(data);
    } else {
        bytes.extend(data.iter().take(3 * rows * columns).flat_map(|byte| number(*byte).to_le_bytes()));
    }
    bytes
}

/// A PCD of points without rows and columns, each with its ring: a byte for each coordinate, and one for
/// the ring.
fn listed(data: &[u8]) -> Vec<u8> {
    let points = data.as_chunks::<4>().0;
    let count = points.len();
    let mut bytes = format!(
        "VERSION .7\nFIELDS x y z ring\nSIZE 4 4 4 1\nTYPE F F F U\nWIDTH {count}\nHEIGHT 1\nPOINTS {count}\nDATA binary\n"
    )
    .into_bytes();
    for [x, y, z, ring] in points {
        bytes.extend([x, y, z].into_iter().flat_map(|byte| number(*byte).to_le_bytes()));
        bytes.push(*ring);
    }
    bytes
}

/// A small number; none for 0.
fn number(byte: u8) -> f32 {
    if byte == 0 { f32::NAN } else { (f32::from(byte) - 100.0) / 16.0 }
}

/// An array of NumPy: its header up to a zero.
fn array(data: &[u8]) -> Vec<u8> {
    let end = data.iter().position(|byte| *byte == 0).unwrap_or(data.len());
    let length = (end as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], &data[..end], data.get(end + 1..).unwrap_or(&[])].concat()
}

/// An E57 file of ours with some bytes changed, each by a place and what it becomes, and the checksums
/// right again.
fn patched(data: &[u8]) -> Vec<u8> {
    const PAGE: usize = 1024;
    let mut bytes = E57.clone();
    for patch in data.chunks_exact(3) {
        let place = usize::from(u16::from_le_bytes([patch[0], patch[1]])) % bytes.len();
        bytes[place] = patch[2];
    }
    for page in bytes.chunks_exact_mut(PAGE) {
        let (data, sum) = page.split_at_mut(PAGE - 4);
        sum.copy_from_slice(&crc32c(data).to_be_bytes());
    }
    bytes
}

fn crc32c(data: &[u8]) -> u32 {
    let step = |sum: u32, _| if sum & 1 == 1 { sum >> 1 ^ 0x82F6_3B78 } else { sum >> 1 };
    !data.iter().fold(!0, |sum, byte| (0..8).fold(sum ^ u32::from(*byte), step))
}

static E57: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let path = scan_file::path("made");
    let mut writer = E57Writer::from_file(&path, "{file}").expect("a writer");
    let index = |name| Record { name, data_type: RecordDataType::Integer { min: 0, max: 3 } };
    let coordinates = [Record::CARTESIAN_X_F32, Record::CARTESIAN_Y_F32, Record::CARTESIAN_Z_F32];
    let indices = [index(RecordName::RowIndex), index(RecordName::ColumnIndex)];
    let mut cloud =
        writer.add_pointcloud("{cloud}", coordinates.into_iter().chain(indices).collect()).expect("a cloud");
    for i in 0..16i64 {
        let point = [2.0, i as f32 / 4.0, 0.5].map(RecordValue::Single);
        let indices = [i / 4, i % 4].map(RecordValue::Integer);
        cloud.add_point(point.into_iter().chain(indices).collect()).expect("a point");
    }
    cloud.finalize().expect("an end");
    writer.finalize().expect("an end");
    drop(writer);
    let bytes = fs::read(&path).expect("the file");
    bytes
});
