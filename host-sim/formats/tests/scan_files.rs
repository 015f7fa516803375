//! Files of others as scans.

use std::path::{Path, PathBuf};

use scanseg_formats::{Kind, ReadOptions, Scan, ScanFile};

/// A recorded file, if the data are there.
fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared").join(name);
    if !path.exists() {
        println!("skipped: {name} is not there");
        return None;
    }
    Some(path)
}

fn read(path: impl AsRef<Path>) -> Scan {
    let mut file = ScanFile::open(path, &ReadOptions::default()).unwrap();
    assert_eq!(file.frames(), 1);
    file.frame(0).unwrap()
}

#[test]
fn look() {
    for name in ["data/office1-kinect/office1.pcd", "data/synpeb/test_100.pcd", "cases/15-organised-cloud/table.pcd"] {
        let Some(path) = shared(name) else { continue };
        let scan = read(path);
        let shown = match &scan.geometry.kind {
            Kind::Free { wraps, .. } => format!("free {wraps}"),
            kind => format!("{kind:.300?}"),
        };
        println!("{name}: {} {:?} {:?} {shown}", scan.measured, scan.remarks, scan.geometry.beside);
    }
}
