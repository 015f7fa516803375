//! Scans that come one after the other in a file, by number.

use crate::file::Cause;
use crate::geometry::Geometry;
use crate::range_image::RangeImage;
use crate::scan::{Frames, ReadOptions, Scan};
use crate::scan_error::ScanError;

/// The scans of a file one after the other.
pub(crate) trait Stream: Send {
    /// Goes on to the next scan. Returns whether there is one.
    fn advance(&mut self) -> Result<bool, Cause>;

    /// Returns the scan to which it has come.
    fn scan(&self) -> Result<Scan, Cause>;
}

/// Opens the file at its start.
type Open = Box<dyn Fn() -> Result<Box<dyn Stream>, Cause> + Send>;

/// The scans by number. To read an earlier one it begins at the start again.
pub(crate) struct Streamed {
    open: Open,
    stream: Box<dyn Stream>,
    /// Number of the scan to which the stream goes on.
    next: usize,
    count: usize,
}

impl Streamed {
    /// Counts the scans, for which all of the file is read. `format` is for messages.
    pub fn new(format: &'static str, open: Open) -> Result<Streamed, Cause> {
        let mut stream = open()?;
        let mut count = 0;
        while stream.advance()? {
            count += 1;
        }
        if count == 0 {
            return Err(ScanError::lacks(format, "a whole scan").into());
        }
        Ok(Streamed { stream: open()?, open, next: 0, count })
    }
}

impl Frames for Streamed {
    fn count(&self) -> usize {
        self.count
    }

    fn read(&mut self, n: usize) -> Result<Scan, Cause> {
        if n < self.next {
            (self.stream, self.next) = ((self.open)()?, 0);
        }
        while self.next <= n {
            if !self.stream.advance()? {
                return Err(ScanError::lacks("a file that changed", "its scans").into());
            }
            self.next += 1;
        }
        let mut scan = self.stream.scan()?;
        if self.count > 1 {
            scan.name = format!("{}, frame {n}", scan.name);
        }
        Ok(scan)
    }
}

/// Returns a scan of a reader that knows where the beams point. Limits and errors are those of the
/// geometry file of the options, if there is one.
pub(crate) fn scan_of(
    name: String,
    (mut image, mut geometry): (RangeImage, Geometry),
    options: &ReadOptions,
    remarks: Vec<String>,
) -> Result<Scan, Cause> {
    if let Some(given) = options.geometry()? {
        geometry = Geometry { kind: geometry.kind, beside: geometry.beside, unit_m: geometry.unit_m, ..given };
        geometry.no_return = vec![];
    }
    let measured = image.range_m.iter().filter(|range_m| **range_m > 0.0).count();
    if measured == 0 {
        return Err(ScanError::NothingMeasured { pixels: image.range_m.len() }.into());
    }
    image.keep_within(&geometry);
    Ok(Scan { name, image, geometry, measured, remarks })
}
