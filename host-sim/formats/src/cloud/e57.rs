//! E57 files of terrestrial scanners, whose points have indices of a row and a column.

use std::io::Cursor;

use e57::{CartesianCoordinate, E57Reader, PointCloud, RecordDataType, RecordName};

use crate::cloud::Cloud;
use crate::file::Cause;
use crate::scan::{Frames, ReadOptions, Scan};
use crate::scan_error::ScanError;

const E57: &str = "E57";

/// The first bytes of every E57 file.
pub(crate) const SIGNATURE: &[u8] = b"ASTM-E57";

const ADVICE: &str = "it has no rowIndex and columnIndex. Export it from the scanner's program as structured (gridded) E57, each \
    scan on its own";

/// A file with its scans.
pub(crate) struct E57File {
    name: String,
    options: ReadOptions,
    bytes: usize,
    reader: E57Reader<Cursor<Vec<u8>>>,
    scans: Vec<PointCloud>,
}

impl E57File {
    pub fn open(name: String, bytes: Vec<u8>, options: &ReadOptions) -> Result<E57File, Cause> {
        let length = bytes.len();
        // the list of its scans, and its pages, are allocated before they are read
        let number = |at: usize| bytes.get(at..)?.first_chunk().map(|b| u64::from_le_bytes(*b));
        if [32, 40].iter().any(|&at| number(at).is_none_or(|size| size > length as u64)) {
            return Err(ScanError::damaged(E57, "its header claims more bytes than the file has").into());
        }
        let reader = E57Reader::new(Cursor::new(bytes)).map_err(|e| ScanError::damaged(E57, e))?;
        let scans = reader.pointclouds();
        if scans.is_empty() {
            return Err(ScanError::lacks(E57, "a scan").into());
        }
        Ok(E57File { name, options: options.clone(), bytes: length, reader, scans })
    }

    fn cloud(&mut self, n: usize) -> Result<Cloud, ScanError> {
        let scan = &self.scans[n];
        let data_type = |name: RecordName| Some(&scan.prototype.iter().find(|r| r.name == name)?.data_type);
        let indices = data_type(RecordName::RowIndex).zip(data_type(RecordName::ColumnIndex));
        let points = usize::try_from(scan.records).unwrap_or(usize::MAX);
        let Some((row_type, column_type)) = indices else {
            return Err(ScanError::Unorganised { points, advice: ADVICE });
        };
        // what is always the same takes no bytes: of that alone there could be any number
        let takes_bytes = |data_type: &RecordDataType| match *data_type {
            RecordDataType::Integer { min, max } | RecordDataType::ScaledInteger { min, max, .. } => min < max,
            RecordDataType::Single { .. } | RecordDataType::Double { .. } => true,
        };
        if !scan.prototype.iter().any(|record| takes_bytes(&record.data_type)) || points > 8 * self.bytes {
            return Err(ScanError::damaged(E57, format!("{points} points in {} bytes", self.bytes)));
        }
        let bounds = scan.index_bounds.clone().unwrap_or_default();
        let of = |least: Option<i64>, most: Option<i64>, data_type: &RecordDataType| match (least, most, data_type) {
            (Some(least), Some(most), _) => Some((least, most)),
            (_, _, RecordDataType::Integer { min, max }) => Some((*min, *max)),
            _ => None,
        };
        let rows = of(bounds.row_min, bounds.row_max, row_type);
        let columns = of(bounds.column_min, bounds.column_max, column_type);
        let (rows, columns) = rows.zip(columns).ok_or_else(|| ScanError::lacks(E57, "bounds of its indices"))?;
        let count = |(least, most): (i64, i64)| {
            let count = most.checked_sub(least).and_then(|n| n.checked_add(1));
            count.and_then(|n| usize::try_from(n).ok()).unwrap_or(usize::MAX)
        };
        let (first_row, first_column) = (rows.0, columns.0);
        let (rows, columns) = (count(rows), count(columns));
        let pixels = ScanError::check_pixels(rows, columns)?;
        if pixels > self.bytes {
            let what = format!("{rows} rows x {columns} columns in {} bytes are nearly all empty", self.bytes);
            return Err(ScanError::damaged(E57, what));
        }
        let mut cloud = Cloud { rows, columns, points: vec![[f32::NAN; 3]; pixels] };
        let mut reader = self.reader.pointcloud_simple(scan).map_err(|e| ScanError::damaged(E57, e))?;
        // where the scanner stood does not matter to its beams
        reader.apply_pose(false);
        for point in reader {
            let point = point.map_err(|e| ScanError::damaged(E57, e))?;
            let place = |index: i64, first: i64, count: usize| {
                index.checked_sub(first).and_then(|i| usize::try_from(i).ok()).filter(|i| *i < count)
            };
            let place = place(point.row, first_row, rows).zip(place(point.column, first_column, columns));
            let (row, column) = place.ok_or_else(|| {
                let what = format!("row {}, column {} is not within its bounds", point.row, point.column);
                ScanError::damaged(E57, what)
            })?;
            let pixel = &mut cloud.points[row * columns + column];
            // of several returns the first
            if let CartesianCoordinate::Valid { x, y, z } = point.cartesian
                && pixel[0].is_nan()
            {
                *pixel = [x, y, z].map(|x| x as f32);
            }
        }
        Ok(cloud)
    }
}

impl Frames for E57File {
    fn count(&self) -> usize {
        self.scans.len()
    }

    fn read(&mut self, n: usize) -> Result<Scan, Cause> {
        let name = if self.scans.len() == 1 { self.name.clone() } else { format!("{} scan {n}", self.name) };
        self.cloud(n)?.into_scan(name, &self.options)
    }
}
