//! Bytes as a file with scans.

use std::fs;
use std::path::PathBuf;

use scanseg_formats::{ReadOptions, ScanFile};

/// Reads the first scans of a file, which fit their geometry.
pub fn read(bytes: &[u8], options: &ReadOptions) {
    let path = path("scan");
    fs::write(&path, bytes).expect("a file");
    let Ok(mut file) = ScanFile::open(&path, options) else { return };
    for n in 0..file.frames().min(4) {
        let Ok(scan) = file.frame(n) else { continue };
        scan.geometry.check().expect("a geometry");
        scan.geometry.fits(scan.image.rows, scan.image.columns).expect("its size");
        assert_eq!(scan.image.range_m.len(), scan.image.rows * scan.image.columns);
        assert!(scan.image.range_m.iter().all(|range_m| range_m.is_finite() && *range_m >= 0.0));
    }
}

/// Returns the path of a file of this process: in memory where there is such a folder.
pub fn path(name: &str) -> PathBuf {
    let folder = PathBuf::from("/dev/shm");
    let folder = if folder.is_dir() { folder } else { std::env::temp_dir() };
    folder.join(format!("scanseg-fuzz-{name}-{}", std::process::id()))
}
