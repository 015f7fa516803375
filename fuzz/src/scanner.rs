//! Settings of an LMS 2xx, and streams of its telegrams with what goes wrong on a line.

use arbitrary::{Arbitrary, Result, Unstructured};
use scanseg_hal::lms2xx::{Baud, MeasuringMode, SCAN_LINE, SUB_RANGE, Settings, Unit, Variant};
use scanseg_virtual_rig::telegrams::{frame, scan_payload};

pub const VARIANTS: [Variant; 5] =
    [Variant::Deg180Step1, Variant::Deg100Step1, Variant::Deg180Step05, Variant::Deg100Step05, Variant::Deg100Step025];
const UNITS: [Unit; 3] = [Unit::Millimetre, Unit::Centimetre, Unit::Decimetre];
const MODES: [MeasuringMode; 8] = [
    MeasuringMode::Range32Field,
    MeasuringMode::Range8Fields,
    MeasuringMode::Range8Reflector,
    MeasuringMode::Range8FieldsAbc,
    MeasuringMode::Range16Reflector,
    MeasuringMode::Range16Fields,
    MeasuringMode::Range32Reflector,
    MeasuringMode::Range32Immediate,
];

/// Any settings.
pub fn settings(u: &mut Unstructured) -> Result<Settings> {
    Ok(Settings {
        baud: *u.choose(&Baud::ALL)?,
        variant: *u.choose(&VARIANTS)?,
        unit: *u.choose(&UNITS)?,
        mode: *u.choose(&MODES)?,
        interlaced: u.arbitrary()?,
    })
}

/// A piece of a stream.
#[derive(Debug, Arbitrary)]
pub enum Piece {
    /// Any bytes.
    Bytes(Vec<u8>),
    /// What claims to begin a telegram.
    Header { length: u16, code: u8 },
    /// A scan: `turn` chooses the partial one of an interlaced scan.
    Scan { index_bytes: u8, status: u8, fill: Fill, turn: u8, damage: Damage },
    /// A scan of a part of the columns.
    SubRange { first: u16, count: u8, status: u8, fill: Fill, damage: Damage },
    /// Any other telegram.
    Telegram { code: u8, data: Vec<u8>, status: u8, damage: Damage },
}

/// Values of a scan: some bytes over and over.
#[derive(Debug, Default, Arbitrary)]
pub struct Fill(Vec<u8>);

impl Fill {
    fn values(&self, count: u16) -> Vec<u16> {
        let mut bytes = self.0.iter().chain([&0x34, &0x05]).cycle().copied();
        (0..count).map(|_| u16::from_le_bytes([bytes.next().unwrap_or(0), bytes.next().unwrap_or(0)])).collect()
    }
}

/// What happens to a telegram on the line.
#[derive(Clone, Copy, Debug, Arbitrary)]
pub enum Damage {
    None,
    Flip { at: u16, bit: u8 },
    Loss { at: u16 },
    Insertion { at: u16, byte: u8 },
    Cut { at: u16 },
}

impl Damage {
    /// Damages bytes, at least one.
    pub fn strike(self, bytes: &mut Vec<u8>) {
        let place = |at: u16| usize::from(at) % bytes.len();
        match self {
            Damage::None => {}
            Damage::Flip { at, bit } => {
                let at = place(at);
                bytes[at] ^= 1 << (bit % 8);
            }
            Damage::Loss { at } => _ = bytes.remove(place(at)),
            Damage::Insertion { at, byte } => bytes.insert(place(at), byte),
            Damage::Cut { at } => bytes.truncate(place(at)),
        }
    }
}

impl Piece {
    /// Its bytes, from a scanner so set.
    pub fn bytes(&self, settings: &Settings) -> Vec<u8> {
        let variant = settings.variant;
        let unit = u16::from(settings.unit.code()) << 14;
        let (payload, damage) = match self {
            Piece::Bytes(bytes) => return bytes.clone(),
            &Piece::Header { length, code } => {
                let [low, high] = length.to_le_bytes();
                return vec![0x02, 0x80, low, high, code];
            }
            Piece::Scan { index_bytes, status, fill, turn, damage } => {
                let turns = variant.mirror_turns();
                let quarter = (u16::from(*turn) % turns * 4 / turns) as u8;
                let (count, bits) = match variant.partial_columns(quarter) {
                    Some(count) if settings.interlaced => (count, 0x2000 | u16::from(quarter) << 11),
                    _ => (variant.columns(), 0),
                };
                let index_bytes = vec![0x55; usize::from(index_bytes % 3).min(401 - usize::from(count))];
                (scan_payload(&[SCAN_LINE], count | bits | unit, &fill.values(count), &index_bytes, *status), damage)
            }
            Piece::SubRange { first, count, status, fill, damage } => {
                let (first, count) = (1 + first % 401, u16::from(*count));
                let last = (first + count).min(401);
                let [[a, b], [c, d]] = [first, last].map(u16::to_le_bytes);
                let values = fill.values(last - first + 1);
                (scan_payload(&[SUB_RANGE, a, b, c, d], (last - first + 1) | unit, &values, &[], *status), damage)
            }
            Piece::Telegram { code, data, status, damage } => {
                let data = data.get(..800).unwrap_or(data);
                ([&[*code][..], data, &[*status]].concat(), damage)
            }
        };
        let mut bytes = frame(&payload);
        damage.strike(&mut bytes);
        bytes
    }
}
