//! Compares two label images pixel by pixel: `same_labels ONE OTHER`. Used by `c_library.sh`.
use std::process::ExitCode;

use scanseg_formats::GreyImage;

fn main() -> ExitCode {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let [one, other] = files.as_slice() else {
        eprintln!("usage: same_labels ONE OTHER");
        return ExitCode::FAILURE;
    };
    let images = [one, other].map(GreyImage::read);
    let [Ok(one), Ok(other)] = images else {
        images.into_iter().filter_map(Result::err).for_each(|error| eprintln!("{error}"));
        return ExitCode::FAILURE;
    };
    if (one.rows, one.columns) != (other.rows, other.columns) {
        eprintln!("{} x {} and {} x {} pixels", one.rows, one.columns, other.rows, other.columns);
        return ExitCode::FAILURE;
    }
    let differ = one.values.iter().zip(&other.values).filter(|(a, b)| a != b).count();
    let labels = one.values.iter().max().copied().unwrap_or(0);
    println!("{differ} of {} pixels differ, {labels} labels", one.values.len());
    if differ == 0 && labels > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
