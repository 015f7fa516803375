//! What the fuzz targets share: scans and telegrams made of a fuzzer's bytes.

pub mod case;
#[cfg(feature = "readers")]
pub mod scan_file;
pub mod scanner;
