//! Clouds that tests make, and their files.
#![allow(dead_code)] // each test uses some of it

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use scanseg_formats::{Geometry, ReadOptions, Scan, ScanFile};

/// Three rows of four columns, of which two pixels were not measured.
pub const POINTS: [[f32; 3]; 12] = [
    [2.0, 0.5, 0.25],
    [f32::NAN, f32::NAN, f32::NAN],
    [2.0, 0.0, 0.25],
    [2.0, -0.5, 0.5],
    [2.5, 0.5, 0.0],
    [2.5, 0.25, 0.0],
    [0.0, 0.0, 0.0],
    [2.5, -0.5, 0.0],
    [3.0, 0.5, -0.25],
    [3.0, 0.25, -0.5],
    [3.0, 0.125, -0.25],
    [3.0, -0.5, -0.75],
];

/// Writes a file of the test's own.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("scan-{}-{count}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    path
}

/// Reads the only scan of a file, or returns what is said of it.
pub fn open_with(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Scan, String> {
    let path = file(name, bytes);
    let scan = ScanFile::open(&path, options).and_then(|mut file| {
        assert_eq!(file.frames(), 1);
        file.frame(0)
    });
    fs::remove_dir_all(path.parent().unwrap()).unwrap();
    scan.map_err(|e| e.to_string())
}

/// Reads the only scan of a file.
pub fn open(name: &str, bytes: &[u8]) -> Scan {
    open_with(name, bytes, &ReadOptions::default()).unwrap()
}

/// Returns what is said of a file that has no scan.
pub fn refused(name: &str, bytes: &[u8]) -> String {
    open_with(name, bytes, &ReadOptions::default()).unwrap_err()
}

/// Points on the beams of a geometry, at ranges of about 3 m.
pub fn points_of(geometry: &Geometry, rows: usize, columns: usize, is_seen: fn(usize, usize) -> bool) -> Vec<[f32; 3]> {
    let point = |i: usize| {
        let (row, column) = (i / columns, i % columns);
        let range_m = 3.0 + (0.1 * row as f64).sin() + 0.5 * (0.07 * column as f64).cos();
        if is_seen(row, column) { geometry.direction(row, column).map(|x| (range_m * x) as f32) } else { [f32::NAN; 3] }
    };
    (0..rows * columns).map(point).collect()
}

/// The same as a file.
pub fn pcd_of(geometry: &Geometry, rows: usize, columns: usize, is_seen: fn(usize, usize) -> bool) -> Vec<u8> {
    binary_pcd(rows, columns, &points_of(geometry, rows, columns, is_seen))
}

fn header(rows: usize, columns: usize, data: &str) -> Vec<u8> {
    let points = rows * columns;
    format!(
        "# .PCD v.7\nVERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {columns}\nHEIGHT {rows}\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
    )
    .into_bytes()
}

pub fn ascii_pcd(rows: usize, columns: usize, lines: &[String]) -> Vec<u8> {
    [header(rows, columns, "ascii"), lines.join("\n").into_bytes(), b"\n".to_vec()].concat()
}

pub fn binary_pcd(rows: usize, columns: usize, points: &[[f32; 3]]) -> Vec<u8> {
    let mut bytes = header(rows, columns, "binary");
    bytes.extend(points.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes
}

/// Packed as it is worst: nothing of it repeats.
pub fn packed_pcd(rows: usize, columns: usize, points: &[[f32; 3]]) -> Vec<u8> {
    let fields = (0..3).flat_map(|axis| points.iter().flat_map(move |point| point[axis].to_le_bytes()));
    let fields: Vec<u8> = fields.collect();
    let packed: Vec<u8> = fields.chunks(32).flat_map(|chunk| [&[chunk.len() as u8 - 1], chunk].concat()).collect();
    let mut bytes = header(rows, columns, "binary_compressed");
    bytes.extend((packed.len() as u32).to_le_bytes());
    bytes.extend((fields.len() as u32).to_le_bytes());
    bytes.extend(packed);
    bytes
}
