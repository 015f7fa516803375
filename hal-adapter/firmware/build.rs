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
    // the images have the handlers of their interrupts in place
    fs::write(out.join("device.x"), "")?;
    if machine == "mps2" && env::var_os("CARGO_FEATURE_FIGURES").is_some() {
        // what scanner and encoder say, from `firmware-check`; without it they are silent
        println!("cargo:rerun-if-env-changed=SCANSEG_TAPE");
        for name in ["stream.bin", "answers.bin"] {
            let bytes = match env::var_os("SCANSEG_TAPE") {
                Some(tape) => fs::read(PathBuf::from(tape).join(name))?,
                None => vec![],
            };
            fs::write(out.join(name), bytes)?;
        }
    }
    println!("cargo:rerun-if-changed={machine}.x");
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    if env::var_os("CARGO_FEATURE_DEFMT").is_some() {
        println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    }
    Ok(())
}
