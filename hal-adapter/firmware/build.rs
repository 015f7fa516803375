//! Puts the machine's memory layout where cortex-m-rt's linker script looks for it, and says which
//! machine it is.
use std::{env, error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let machine = match env::var("TARGET")?.as_str() {
        "thumbv6m-none-eabi" => "microbit",
        "thumbv7em-none-eabihf" => "mps2",
        _ => return Ok(()),
    };
    println!("cargo:rustc-cfg=machine=\"{machine}\"");
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::copy(format!("{machine}.x"), out.join("memory.x"))?;
    // no handlers of interrupts
    fs::write(out.join("device.x"), "")?;
    println!("cargo:rerun-if-changed={machine}.x");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if env::var_os("CARGO_FEATURE_DEFMT").is_some() {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
    Ok(())
}
