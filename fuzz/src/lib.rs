//! What the fuzz targets share: scans, telegrams and files made of a fuzzer's bytes.

pub mod case;
pub mod scanner;

/// Code of the tests of other packages that targets use.
#[path = "../../core/capi/tests/common/mod.rs"]
pub mod capi_tests;
#[path = "../../hal-adapter/tests/common/mod.rs"]
pub mod hal_tests;

/// The parts of scanseg-sim that read files and play the scanner. They stand alone, and so their crate with its pictures and
/// its command need not be built.
#[path = "../../host-sim/src/format/mod.rs"]
pub mod format;
#[path = "../../host-sim/src/virtual_rig"]
pub mod virtual_rig {
    pub mod lms2xx;
    pub mod wires;
}
