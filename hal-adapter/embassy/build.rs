//! Puts the memory layout of the board where cortex-m-rt's linker script looks for it.
use std::{env, error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    for board in ["stm32f407", "rp2350"] {
        println!("cargo:rerun-if-changed={board}.x");
        if env::var_os(format!("CARGO_FEATURE_{}", board.to_uppercase())).is_some() {
            let out = PathBuf::from(env::var("OUT_DIR")?);
            fs::copy(format!("{board}.x"), out.join("memory.x"))?;
            println!("cargo:rustc-link-search={}", out.display());
            println!("cargo:rustc-link-arg-bins=-Tlink.x");
            println!("cargo:rustc-link-arg-bins=--nmagic");
        }
    }
    Ok(())
}
