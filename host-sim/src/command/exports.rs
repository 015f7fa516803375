//! What `scanseg segment --write` adds to the folder of results.

use clap::{Args, ValueEnum};
#[cfg(feature = "ros")]
use scanseg_sim::export::mcap;
use scanseg_sim::export::outlines::Outlines;
use scanseg_sim::export::{Segmented, points};

use crate::command::output::{Failure, Files};

/// What is written beside the usual results.
#[derive(Args, Default)]
pub struct ExportOptions {
    /// Also write, for other programs: outlines.ply; points.pcd; outlines.json;
    /// outlines.csv; outlines.geojson; recording.mcap (feature ros). See docs/formats.md
    #[arg(long, value_enum, value_name = "LIST", value_delimiter = ',')]
    write: Vec<Export>,
}

#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Export {
    /// Outlines of the segments, as faces
    Ply,
    /// Labelled points, organised
    Pcd,
    /// Outlines of the segments
    Json,
    /// Corners of the outlines, one a line
    Csv,
    /// Outlines as polygons, in metres
    Geojson,
    /// Points and planes row by row, as ROS 2 messages
    #[cfg(feature = "ros")]
    Mcap,
}

impl ExportOptions {
    /// Returns the files.
    pub fn files(&self, scan: &Segmented<'_>) -> Result<Files, Failure> {
        let mut files: Vec<(&str, Vec<u8>)> = vec![];
        let asked = |export: Export| self.write.contains(&export);
        if asked(Export::Pcd) {
            files.push(("points.pcd", points::pcd(scan)));
        }
        #[cfg(feature = "ros")]
        if asked(Export::Mcap) {
            files.push(("recording.mcap", mcap::mcap(scan)?));
        }
        if [Export::Ply, Export::Json, Export::Csv, Export::Geojson].into_iter().any(asked) {
            let outlines = Outlines::of(scan);
            let mut push = |export, name, bytes: &dyn Fn() -> serde_json::Result<Vec<u8>>| {
                if asked(export) { bytes().map(|bytes| files.push((name, bytes))) } else { Ok(()) }
            };
            push(Export::Ply, "outlines.ply", &|| Ok(outlines.ply()))?;
            push(Export::Json, "outlines.json", &|| outlines.json())?;
            push(Export::Csv, "outlines.csv", &|| Ok(outlines.csv()))?;
            push(Export::Geojson, "outlines.geojson", &|| outlines.geojson())?;
        }
        Ok(files.into_iter().map(|(name, bytes)| (name.to_string(), bytes)).collect())
    }
}
