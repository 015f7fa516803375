//! What a scanner and its tilt said, with the times: a capture. Text, one event a line:
//!
//! ```text
//! scanseg capture 1
//! scanner baud 500000 columns 181 unit_mm 1 mode 6 interlaced false
//! limits 0.3 0.9 inf 1000000
//! tilt 1000000 0.25
//! tilt failed
//! bytes 1014000 0280760...
//! ```
//!
//! - `scanner`: [`Settings`]; the mode by its code.
//! - `limits`: [`TiltLimits`] in the order of the fields.
//! - `tilt`: microseconds, turn angle in radians; or that the encoder gave none.
//! - `bytes`: microseconds at which the last of them came, the bytes in hexadecimal.
//!
//! A raw stream of telegrams has neither settings nor times nor turn angles:
//! [`Capture::of_telegrams`] takes the turn angles from a geometry file.

use std::error::Error;
use std::fmt;
use std::fmt::Write;

use scanseg_hal::Latch;
use scanseg_hal::lms2xx::{Baud, Event, MeasuringMode, ScanLine, Settings, TelegramDecoder, Unit, Variant};
use scanseg_hal::pairing::BeamAges;
use scanseg_hal::rig::TiltLimits;

use crate::angles::Angles;
use crate::geometry::{Geometry, Kind, TurnAxis};

/// First line of a capture.
pub const HEAD: &str = "scanseg capture 1";

/// With this begins a capture of any version.
pub const MAGIC: &str = "scanseg capture ";

/// A capture.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// How the scanner was set up.
    pub settings: Settings,
    /// How its tilt moved.
    pub limits: TiltLimits,
    /// What came, in order.
    pub events: Vec<CaptureEvent>,
}

/// One event of a capture.
#[derive(Clone, Debug, PartialEq)]
pub enum CaptureEvent {
    /// A sample of the tilt, or `None` if it failed.
    Tilt(Option<Latch>),
    /// Bytes of the scanner.
    Bytes {
        /// When the last of them came.
        time_us: u64,
        /// The bytes.
        bytes: Vec<u8>,
    },
}

/// Why bytes are no capture.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CaptureError {
    /// A line that is not as it should be, counted from 1.
    Line(usize),
    /// A capture of another version than 1, which it names.
    Version(String),
    /// The settings are missing or none that a scanner has.
    Settings,
    /// There is no scan telegram in a raw stream.
    NoTelegram,
    /// No variant of the scanner sends all scan telegrams of a raw stream.
    Variant,
    /// The geometry is not that of a nodding scanner with so many columns.
    Geometry {
        /// Columns of the first scan.
        columns: u16,
    },
}

impl fmt::Display for CaptureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line} is not understood"),
            Self::Version(version) => write!(f, "a capture of version {version}, not 1"),
            Self::Settings => write!(f, "settings of the scanner are missing or wrong"),
            Self::NoTelegram => write!(f, "no scan of an LMS 2xx in it"),
            Self::Variant => write!(f, "its scans are not of one variant of an LMS 2xx"),
            Self::Geometry { columns } => {
                write!(f, "scans of {columns} columns need the geometry of a nodding scanner with as many")
            }
        }
    }
}

impl Error for CaptureError {}

impl Capture {
    /// Without events.
    #[must_use]
    pub fn new(settings: Settings, limits: TiltLimits) -> Capture {
        Capture { settings, limits, events: vec![] }
    }

    /// As text.
    #[must_use]
    pub fn to_text(&self) -> String {
        let Settings { baud, variant, unit, mode, interlaced } = self.settings;
        let (baud, columns, unit_mm, mode) = (baud.bits_per_s(), variant.columns(), unit.mm(), mode.code());
        let TiltLimits { min_rate_rad_per_s: min, max_rate_rad_per_s: max, sweep_rad, pause_us } = self.limits;
        let mut text = format!(
            "{HEAD}\nscanner baud {baud} columns {columns} unit_mm {unit_mm} mode {mode} interlaced {interlaced}\n\
             limits {min} {max} {sweep_rad} {pause_us}\n"
        );
        for came in &self.events {
            match came {
                CaptureEvent::Tilt(Some(Latch { turn_rad, time_us })) => {
                    _ = writeln!(text, "tilt {time_us} {turn_rad}")
                }
                CaptureEvent::Tilt(None) => text += "tilt failed\n",
                CaptureEvent::Bytes { time_us, bytes } => {
                    _ = write!(text, "bytes {time_us} ");
                    bytes.iter().for_each(|byte| _ = write!(text, "{byte:02X}"));
                    text.push('\n');
                }
            }
        }
        text
    }

    /// Reads the text of a capture.
    ///
    /// # Errors
    /// [`CaptureError::Version`], [`CaptureError::Line`] or [`CaptureError::Settings`].
    pub fn parse(text: &str) -> Result<Capture, CaptureError> {
        let head = text.lines().next().unwrap_or_default();
        if let Some(version) = head.strip_prefix(MAGIC).filter(|_| head != HEAD) {
            return Err(CaptureError::Version(version.chars().take(20).collect()));
        }
        let (mut settings, mut limits, mut events) = (None, None, vec![]);
        for (number, line) in (1..).zip(text.lines()) {
            let words: Vec<&str> = line.split_whitespace().collect();
            let understood = match words[..] {
                _ if number == 1 => line == HEAD,
                [] => true,
                ["scanner", "baud", baud, "columns", columns, "unit_mm", unit_mm, "mode", mode, "interlaced", i] => {
                    settings = self::settings(baud, columns, unit_mm, mode, i);
                    settings.is_some()
                }
                ["limits", min, max, sweep, pause] => {
                    limits = self::limits(min, max, sweep, pause);
                    limits.is_some()
                }
                _ => {
                    let event = event(&words);
                    let understood = event.is_some();
                    events.extend(event);
                    understood
                }
            };
            if !understood {
                return Err(CaptureError::Line(number));
            }
        }
        let (settings, limits) = settings.zip(limits).ok_or(CaptureError::Settings)?;
        Ok(Capture { settings, limits, events })
    }

    /// Makes a capture of a raw stream of telegrams: as if they had come at 38 400 Bd, one after
    /// the other, and the turn angle of the geometry's row r had held for the r-th. The place of a
    /// telegram in the stream says which it is, so that a damaged one costs its own row only; where
    /// whole telegrams are missing from the stream, nothing tells. `range_bits` is 13 to 16, see
    /// [`MeasuringMode::range_bits`].
    ///
    /// Also returns the geometry of the rows: that given, with all columns of the scanner's variant.
    /// Its first angle is that of the first value of a telegram; its step is the scanner's, or for
    /// partial scan lines also that of one of them, 1 degree.
    ///
    /// # Errors
    /// [`CaptureError::NoTelegram`], [`CaptureError::Variant`] or [`CaptureError::Geometry`].
    pub fn of_telegrams(raw: &[u8], geometry: &Geometry, range_bits: u32) -> Result<(Capture, Geometry), CaptureError> {
        let Telegrams { settings, sweep, length, starts, first_column, columns } =
            Telegrams::find(raw, geometry, range_bits)?;
        let Kind::Nodding { beam_deg, turn_deg, turn_axis } = &geometry.kind else {
            return Err(CaptureError::Geometry { columns });
        };
        let rows = match turn_deg {
            Angles::Even { .. } => raw.len(),
            Angles::Listed(list) => list.len(),
        };
        let beam_deg = all_columns(beam_deg, &settings, first_column).ok_or(CaptureError::Geometry { columns })?;
        let kind = Kind::Nodding { beam_deg, turn_deg: turn_deg.clone(), turn_axis: *turn_axis };
        let of_rows = Geometry { kind, ..geometry.clone() };
        if of_rows.fits(rows, settings.variant.columns().into()).is_err() {
            return Err(CaptureError::Geometry { columns });
        }
        let period_us = u64::from(settings.period_us());
        let limits = TiltLimits {
            min_rate_rad_per_s: 1e-6,
            max_rate_rad_per_s: 0.99e6 * std::f32::consts::PI / period_us as f32,
            sweep_rad: f32::INFINITY,
            pause_us: 100 * settings.period_us(),
        };
        // Row r begins at (r + 2) periods.
        let begin_us = |row: usize| (row as u64 + 2) * period_us;
        let mut events = vec![];
        let mut row = 0;
        let ends = starts.iter().skip(1).copied().chain([raw.len()]);
        for (&start, end) in starts.iter().zip(ends) {
            let next_row = row + ((end - start + length / 2) / length).max(1);
            for (piece, bytes) in raw[start..end].chunks(64).enumerate() {
                let sent = (64 * piece + bytes.len() - 1) as u32;
                // What comes before the next start byte has come before its time, however much it
                // is.
                let time_us = begin_us(row) + u64::from(settings.baud.line_time_us(sent));
                let time_us = time_us.min(begin_us(next_row) - 1);
                events.push((time_us, CaptureEvent::Bytes { time_us, bytes: bytes.to_vec() }));
            }
            row = next_row;
        }
        // Also one of the row before the first, so that the first has a rate.
        let before_deg = 2.0 * turn_deg.at(0) - turn_deg.at(1.min(rows - 1));
        let turns = std::iter::once(before_deg).chain((0..row.min(rows)).map(|row| turn_deg.at(row)));
        for (row, deg) in turns.enumerate() {
            let time_us = begin_us(row) - period_us - sweep.mean_age_us() as u64;
            events.push((time_us, CaptureEvent::Tilt(Some(Latch { turn_rad: deg.to_radians() as f32, time_us }))));
        }
        events.sort_by_key(|(time_us, _)| *time_us);
        let events = events.into_iter().map(|(_, came)| came).collect();
        Ok((Capture { settings, limits, events }, of_rows))
    }
}

/// Returns the geometry of an LMS 2xx that tilts, see [`scanseg_hal::rig::beams`]. Turn angles come
/// with the rows.
#[must_use]
pub fn geometry_on_tilt(variant: Variant) -> Geometry {
    let beam_deg = Angles::Even {
        start_deg: -f64::from(variant.view_deg()) / 2.0,
        step_deg: f64::from(variant.step_cdeg()) / 100.0,
    };
    let turn_deg = Angles::Even { start_deg: 0.0, step_deg: 1.0 };
    Geometry::of(Kind::Nodding { beam_deg, turn_deg, turn_axis: TurnAxis::Y })
}

/// Returns the angles of all columns of a scanner, of which those given are the angles of a telegram
/// that begins with this column; `None` if they do not fit.
fn all_columns(beam_deg: &Angles, settings: &Settings, first_column: u16) -> Option<Angles> {
    let scanner_deg = f64::from(settings.variant.step_cdeg()) / 100.0;
    let (start_deg, step_deg) = match beam_deg {
        Angles::Even { start_deg, step_deg } => (*start_deg, *step_deg),
        Angles::Listed(_) if settings.interlaced || first_column > 0 => return None,
        Angles::Listed(list) => return Some(Angles::Listed(list.clone())),
    };
    // the angles of a complete scan may be stretched: a scanner that bends
    let partial = settings.interlaced && (step_deg.abs() - 1.0).abs() < 1e-3;
    let whole = (step_deg.abs() - scanner_deg).abs() < 0.1 * scanner_deg;
    let step_deg = if partial { scanner_deg.copysign(step_deg) } else { step_deg };
    let start_deg = start_deg - f64::from(first_column) * step_deg;
    (partial || whole || !settings.interlaced).then_some(Angles::Even { start_deg, step_deg })
}

/// The scans of a raw stream.
struct Telegrams {
    settings: Settings,
    sweep: BeamAges,
    /// Bytes of one.
    length: usize,
    /// Where the good ones begin.
    starts: Vec<usize>,
    /// Column of the first value of a telegram, and values of the first telegram.
    first_column: u16,
    columns: u16,
}

impl Telegrams {
    /// Finds all that are good, and the variant that sends such ones. Those of another unit or kind
    /// than most are counted among them: each has its turn angle.
    fn find(raw: &[u8], geometry: &Geometry, range_bits: u32) -> Result<Telegrams, CaptureError> {
        let mode = MeasuringMode::ALL.into_iter().find(|mode| mode.range_bits() == range_bits);
        let mode = mode.ok_or(CaptureError::NoTelegram)?;
        let starts = good_scans(raw, |_| true);
        let with_scan = |interlaced| {
            let variants = Variant::ALL.into_iter().map(move |variant| (variant, interlaced));
            variants.map(|(variant, interlaced)| {
                let fits = |line: &ScanLine<'_>| line.fits(variant) && line.partial_quarter().is_some() == interlaced;
                (good_scans(raw, fits), variant, interlaced)
            })
        };
        // of the variants that send most of them the one with the step of the geometry, then the one
        // with the fewest columns
        let step_cdeg = match geometry.kind {
            Kind::Nodding { beam_deg: Angles::Even { step_deg, .. }, .. } => (100.0 * step_deg.abs()).round() as u16,
            _ => 0,
        };
        let all = [false, true].into_iter().flat_map(with_scan);
        let best = all.min_by_key(|(scans, variant, _)| {
            (std::cmp::Reverse(scans.len()), variant.step_cdeg() != step_cdeg, variant.columns())
        });
        let (Some((scans, variant, interlaced)), false) = (best, starts.is_empty()) else {
            return Err(CaptureError::NoTelegram);
        };
        if 2 * scans.len() <= starts.len() {
            return Err(CaptureError::Variant);
        }
        let mut decoder = TelegramDecoder::new();
        let first = *scans.first().ok_or(CaptureError::NoTelegram)?;
        let mut rest = &raw[first..];
        loop {
            let fed = decoder.feed(rest);
            rest = &rest[fed.used..];
            if let Some(telegram) = decoder.telegram()
                && let Some(scan) = telegram.scan_line()
            {
                let settings = Settings { baud: Baud::B38400, variant, unit: scan.unit(), mode, interlaced };
                // Code, status, header and check word beside the data.
                let length = telegram.data().len() + 2 + 4 + 2;
                let (sweep, first_column) = (BeamAges::of(&scan, variant), scan.first_column());
                return Ok(Telegrams { settings, sweep, length, starts, first_column, columns: scan.columns() });
            }
            if fed.event == Event::NeedMore {
                return Err(CaptureError::NoTelegram);
            }
        }
    }
}

/// Returns where the good scan telegrams begin that are as asked for.
fn good_scans(raw: &[u8], mut asked_for: impl FnMut(&ScanLine<'_>) -> bool) -> Vec<usize> {
    let (mut decoder, mut used, mut start, mut starts) = (TelegramDecoder::new(), 0, 0, vec![]);
    loop {
        let fed = decoder.feed(&raw[used..]);
        used += fed.used;
        match fed.event {
            Event::NeedMore => return starts,
            Event::Start { bytes_ago } => start = used - 1 - usize::from(bytes_ago),
            _ => {
                let scan = decoder.telegram().and_then(|telegram| telegram.scan_line());
                if scan.is_some_and(|scan| asked_for(&scan)) {
                    starts.push(start);
                }
            }
        }
    }
}

fn variant(columns: u16) -> Option<Variant> {
    Variant::ALL.into_iter().find(|variant| variant.columns() == columns)
}

fn settings(baud: &str, columns: &str, unit_mm: &str, mode: &str, interlaced: &str) -> Option<Settings> {
    let (baud, unit_mm, mode): (u32, u32, u8) = (baud.parse().ok()?, unit_mm.parse().ok()?, mode.parse().ok()?);
    Some(Settings {
        baud: Baud::ALL.into_iter().find(|rate| rate.bits_per_s() == baud)?,
        variant: variant(columns.parse().ok()?)?,
        unit: Unit::ALL.into_iter().find(|unit| unit.mm() == unit_mm)?,
        mode: MeasuringMode::ALL.into_iter().find(|known| known.code() == mode)?,
        interlaced: interlaced.parse().ok()?,
    })
}

fn limits(min: &str, max: &str, sweep: &str, pause: &str) -> Option<TiltLimits> {
    Some(TiltLimits {
        min_rate_rad_per_s: min.parse().ok()?,
        max_rate_rad_per_s: max.parse().ok()?,
        sweep_rad: sweep.parse().ok()?,
        pause_us: pause.parse().ok()?,
    })
}

fn event(words: &[&str]) -> Option<CaptureEvent> {
    Some(match words {
        ["tilt", "failed"] => CaptureEvent::Tilt(None),
        ["tilt", time_us, turn_rad] => {
            CaptureEvent::Tilt(Some(Latch { turn_rad: turn_rad.parse().ok()?, time_us: time_us.parse().ok()? }))
        }
        ["bytes", time_us, hex] => CaptureEvent::Bytes { time_us: time_us.parse().ok()?, bytes: from_hex(hex)? },
        _ => return None,
    })
}

fn from_hex(hex: &str) -> Option<Vec<u8>> {
    let digit = |byte: u8| char::from(byte).to_digit(16).map(|digit| digit as u8);
    let (pairs, rest) = hex.as_bytes().as_chunks::<2>();
    let bytes = pairs.iter().map(|&[high, low]| Some(digit(high)? << 4 | digit(low)?)).collect();
    if rest.is_empty() { bytes } else { None }
}
