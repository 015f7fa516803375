//! Puts the memory layout of the machine where cortex-m-rt's linker script looks for it.
use std::{env, error::Error, fs, path::PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let layout = match env::var("TARGET")?.as_str() {
        "thumbv6m-none-eabi" => "microbit.x",
        _ => "mps2.x",
    };
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::copy(layout, out.join("memory.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed={layout}");
    Ok(())
}
