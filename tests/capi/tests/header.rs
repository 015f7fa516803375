//! `include/scanseg.h` is what cbindgen makes of the crate, and what it says holds for the library.
//! After a change: `UPDATE_HEADER=1 cargo test -p scanseg-capi-tests --features header`.

#[test]
#[cfg_attr(not(feature = "header"), ignore = "takes --features header; in the gate with c_library")]
fn the_header_is_that_of_the_crate() {
    #[cfg(feature = "header")]
    compare();
}

#[cfg(feature = "header")]
fn compare() {
    use std::fs;
    use std::path::Path;

    let root = &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../core/capi");
    let mut builder = cbindgen::Builder::new().with_config(cbindgen::Config::from_root_or_default(root));
    for file in ["status", "config", "event", "output", "state", "lib", "check"] {
        builder = builder.with_src(root.join(format!("src/{file}.rs")));
    }
    let mut made = Vec::new();
    builder.generate().unwrap().write(&mut made);
    let made = String::from_utf8(made).unwrap();
    let path = root.join("include/scanseg.h");
    if std::env::var_os("UPDATE_HEADER").is_some() {
        fs::write(&path, &made).unwrap();
    }
    let kept = fs::read_to_string(&path).unwrap();
    let differs = kept.lines().zip(made.lines()).position(|(kept, made)| kept != made);
    assert!(kept == made, "include/scanseg.h is out of date, from line {:?} on", differs.map(|line| line + 1));
}

#[test]
fn the_version_is_that_of_the_package() {
    let version =
        [scanseg_capi::SCANSEG_VERSION_MAJOR, scanseg_capi::SCANSEG_VERSION_MINOR, scanseg_capi::SCANSEG_VERSION_PATCH];
    assert_eq!(version.map(|number| number.to_string()).join("."), env!("CARGO_PKG_VERSION"));
    assert_eq!(scanseg_capi::scanseg_version_number(), 10_000 * version[0] + 100 * version[1] + version[2]);
}
