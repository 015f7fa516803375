//! Scans of a packet capture: which lidar it is of, and its frames.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use crate::file::{Cause, FileError, read_at_most};
use crate::lidar::datagrams::{Datagrams, Flow};
use crate::lidar::ouster::{Assembler, OusterFrame};
use crate::lidar::ouster_metadata::{MAX_METADATA_BYTES, Metadata};
use crate::lidar::turns::{Turn, Turns};
use crate::lidar::velodyne::{Model, PACKET_BYTES};
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;
use crate::streamed::{Stream, Streamed, scan_of};

/// So many datagrams are looked at for those of a Velodyne.
const LOOKED_AT: usize = 10_000;

/// Returns the scans of a capture.
pub(crate) fn frames(path: &Path, options: &ReadOptions) -> Result<Streamed, Cause> {
    let (path, mut options) = (path.to_path_buf(), options.clone());
    if let Some(model) = velodyne(&path)? {
        let open = move || -> Result<Box<dyn Stream>, Cause> {
            let captured = Captured::open(&path, &options)?;
            Ok(Box::new(Velodyne { captured, turns: Turns::new(model), turn: None }))
        };
        return Streamed::new(FORMAT, Box::new(open));
    }
    let metadata = match options.geometry.take_if(|path| path.extension() == Some(OsStr::new("json"))) {
        Some(path) => read_metadata(&path)?,
        None => read_metadata(&metadata_beside(&path)?)?,
    };
    let open = move || -> Result<Box<dyn Stream>, Cause> {
        let captured = Captured::open(&path, &options)?;
        Ok(Box::new(Ouster { captured, assembler: Assembler::new(metadata.clone()), frame: None }))
    };
    Streamed::new(FORMAT, Box::new(open))
}

const FORMAT: &str = "a packet capture";

/// Returns the Velodyne of which packets are in a capture.
fn velodyne(path: &Path) -> Result<Option<Model>, Cause> {
    let mut datagrams = Datagrams::new(File::open(path)?)?;
    for _ in 0..LOOKED_AT {
        let Some(datagram) = datagrams.next_datagram()? else { break };
        if datagram.payload.len() == PACKET_BYTES && datagram.payload.starts_with(&[0xFF, 0xEE]) {
            return Ok(Some(Model::of(datagram.payload)?));
        }
    }
    Ok(None)
}

/// Reads a file of metadata of an Ouster.
///
/// # Errors
/// What the system says, or [`ScanError::Damaged`]; with the name of the file.
pub fn read_metadata(path: &Path) -> Result<Metadata, FileError> {
    let read = || -> Result<Metadata, Cause> {
        let bytes = read_at_most(path, MAX_METADATA_BYTES)?;
        Ok(Metadata::parse(&String::from_utf8_lossy(&bytes))?)
    };
    read().map_err(|cause| FileError::of(path, cause))
}

/// Returns the JSON file beside a capture whose name begins most like its own.
fn metadata_beside(capture: &Path) -> Result<PathBuf, Cause> {
    let folder = match capture.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let own = capture.file_stem().unwrap_or_default().as_encoded_bytes();
    let alike = |path: &PathBuf| {
        let name = path.file_stem().unwrap_or_default().as_encoded_bytes();
        name.iter().zip(own).take_while(|(a, b)| a == b).count()
    };
    let entries = fs::read_dir(folder)?.collect::<io::Result<Vec<_>>>()?;
    let is_json = |path: &PathBuf| path.extension() == Some(OsStr::new("json"));
    let found: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).filter(is_json).collect();
    let most = found.iter().map(alike).max().unwrap_or(0);
    let mut best = found.into_iter().filter(|path| alike(path) == most);
    match (best.next(), best.next()) {
        (Some(path), None) => Ok(path),
        (None, _) => Err(ScanError::lacks(
            FORMAT,
            "packets of a Velodyne, and for an Ouster its metadata (JSON) must lie beside it or be given by --geometry",
        )
        .into()),
        (Some(a), Some(b)) => {
            let [a, b] = [a, b].map(|path| path.display().to_string());
            let what = format!("a hint which metadata is its own, {a} or {b}: give it by --geometry");
            Err(ScanError::lacks(FORMAT, what).into())
        }
    }
}

/// A capture, of which the datagrams of one sender are taken.
struct Captured {
    name: String,
    options: ReadOptions,
    datagrams: Datagrams,
    flow: Option<Flow>,
}

impl Captured {
    fn open(path: &Path, options: &ReadOptions) -> Result<Captured, Cause> {
        let datagrams = Datagrams::new(File::open(path)?)?;
        Ok(Captured { name: path.display().to_string(), options: options.clone(), datagrams, flow: None })
    }

    /// Returns the next packet of so many bytes from the first who sent one.
    fn next_packet(&mut self, bytes: usize) -> Result<Option<&[u8]>, Cause> {
        // The borrow of a datagram that is returned from within a loop lasts as long as the loop.
        loop {
            match self.datagrams.next_datagram()? {
                None => return Ok(None),
                Some(datagram) if datagram.payload.len() != bytes => {}
                Some(datagram) if *self.flow.get_or_insert(datagram.flow) != datagram.flow => {}
                Some(_) => break,
            }
        }
        Ok(Some(self.datagrams.payload()))
    }
}

struct Ouster {
    captured: Captured,
    assembler: Assembler,
    frame: Option<OusterFrame>,
}

impl Stream for Ouster {
    fn advance(&mut self) -> Result<bool, Cause> {
        self.frame = None;
        let bytes = self.assembler.metadata().packet_bytes();
        while self.frame.is_none() {
            match self.captured.next_packet(bytes)? {
                Some(packet) => self.frame = self.assembler.push(packet),
                None => {
                    self.frame = self.assembler.finish();
                    break;
                }
            }
        }
        Ok(self.frame.is_some())
    }

    fn scan(&self) -> Result<Scan, Cause> {
        let frame = self.frame.as_ref().ok_or(ScanError::Unknown)?;
        let metadata = self.assembler.metadata();
        let (image, geometry) = metadata.image(frame);
        let mut remarks = vec![];
        if frame.came < image.columns {
            remarks.push(format!("{} of {} columns came", frame.came, image.columns));
        }
        scan_of(self.captured.name.clone(), (image, geometry), &self.captured.options, remarks)
    }
}

struct Velodyne {
    captured: Captured,
    turns: Turns,
    turn: Option<Turn>,
}

impl Stream for Velodyne {
    fn advance(&mut self) -> Result<bool, Cause> {
        self.turn = None;
        while self.turn.is_none() {
            match self.captured.next_packet(PACKET_BYTES)? {
                Some(packet) => self.turn = self.turns.push(packet),
                None => {
                    self.turn = self.turns.finish();
                    break;
                }
            }
        }
        Ok(self.turn.is_some())
    }

    fn scan(&self) -> Result<Scan, Cause> {
        let turn = self.turn.as_ref().ok_or(ScanError::Unknown)?;
        scan_of(self.captured.name.clone(), turn.image(), &self.captured.options, turn.remarks())
    }
}
