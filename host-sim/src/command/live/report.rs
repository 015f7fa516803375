//! What is said of each turn: a line, and its segments as CSV.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use scanseg_core::{Join, Label, LabelRow, Segment, Sink};

use crate::command::output::{Failure, print};

const HEAD: &str = ",pixels,distance_m,normal_x,normal_y,normal_z,centroid_x_m,centroid_y_m,centroid_z_m\n";

/// The turn in progress, and where turns are reported.
pub struct Report {
    /// What a turn is called.
    word: &'static str,
    out: Option<(PathBuf, BufWriter<File>)>,
    turns: Option<u32>,
    min_pixels: u32,
    turn: u32,
    rows: u64,
    segments: BTreeMap<Label, Segment>,
    begun: Instant,
    lag_sum: Duration,
    lag_most: Duration,
    packets: u32,
}

impl Report {
    pub fn new(word: &'static str, out: Option<&Path>, turns: Option<u32>, min_pixels: u32) -> Result<Report, Failure> {
        let open = |path: &Path| -> Result<_, Failure> {
            let failed = |e| format!("{}: {e}", path.display());
            let mut file = BufWriter::new(File::create(path).map_err(failed)?);
            file.write_all(format!("{word}{HEAD}").as_bytes()).map_err(failed)?;
            Ok((path.to_path_buf(), file))
        };
        let (segments, begun) = (BTreeMap::new(), Instant::now());
        let (lag_sum, lag_most) = (Duration::ZERO, Duration::ZERO);
        let out = out.map(open).transpose()?;
        Ok(Report { word, out, turns, min_pixels, turn: 0, rows: 0, segments, begun, lag_sum, lag_most, packets: 0 })
    }

    /// Notes that a packet which came at this time has been segmented.
    pub fn packet_done(&mut self, came: Instant) {
        let lag = came.elapsed();
        self.lag_sum += lag;
        self.lag_most = self.lag_most.max(lag);
        self.packets += 1;
    }

    /// Takes the segments of a whole scan.
    #[cfg(feature = "ros2")]
    pub fn take(&mut self, rows: usize, segments: &[Segment]) {
        self.rows += rows as u64;
        self.segments.extend(segments.iter().map(|segment| (segment.label, *segment)));
    }

    /// Ends a turn. Returns whether there is to be another.
    pub fn turn_done(&mut self, lost: &str) -> Result<bool, Failure> {
        if self.rows > 0 {
            self.write()?;
            let seconds = self.begun.elapsed().as_secs_f64().max(1e-9);
            let lag_ms = 1e3 * self.lag_sum.as_secs_f64() / f64::from(self.packets.max(1));
            let most_ms = 1e3 * self.lag_most.as_secs_f64();
            let planes =
                self.segments.values().filter(|s| s.pixels() >= self.min_pixels && s.plane().is_some()).count();
            print(&format!(
                "{} {}: {} rows, {planes} planes; {:.0} rows/s, lag {lag_ms:.2} ms, at most {most_ms:.2} ms; {lost}\n",
                self.word,
                self.turn,
                self.rows,
                self.rows as f64 / seconds
            ))?;
            self.turn += 1;
        }
        self.segments.clear();
        (self.rows, self.packets, self.begun) = (0, 0, Instant::now());
        (self.lag_sum, self.lag_most) = (Duration::ZERO, Duration::ZERO);
        Ok(self.turns.is_none_or(|turns| self.turn < turns))
    }

    /// Writes the segments of a turn, the largest first, and hands them to the system.
    fn write(&mut self) -> Result<(), Failure> {
        let Some((path, file)) = &mut self.out else { return Ok(()) };
        let mut listed: Vec<&Segment> = self.segments.values().filter(|s| s.pixels() >= self.min_pixels).collect();
        listed.sort_by_key(|segment| std::cmp::Reverse(segment.pixels()));
        let mut lines = String::new();
        for segment in listed {
            let [x, y, z] = segment.centroid_m();
            let Some(plane) = segment.plane() else { continue };
            let ([a, b, c], d) = (plane.normal, plane.distance_m);
            lines += &format!("{},{},{d:.4},{a:.5},{b:.5},{c:.5},{x:.4},{y:.4},{z:.4}\n", self.turn, segment.pixels());
        }
        file.write_all(lines.as_bytes())
            .and_then(|()| file.flush())
            .map_err(|e| format!("{}: {e}", path.display()).into())
    }
}

impl Sink for Report {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        self.rows += 1;
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.segments.remove(&join.from);
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.segments.insert(segment.label, *segment);
        ControlFlow::Continue(())
    }
}
