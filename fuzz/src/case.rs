//! Scans and configurations: mostly such as there are, so that more than refusals and missing
//! returns is seen, with any bits in any place.

use arbitrary::{Arbitrary, Result, Unstructured};
use scanseg_core::{
    AnyConfig, AnySegmenter, Approach, ConfigError, EdgeConfig, Element, PlaneConfig, Ranging, RegionConfig, Trace,
    TurnAxis, live_labels,
};
use scanseg_tests::scenes::scan_of;
use scanseg_tests::stream::{Angles, Rig, Room, Scan};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

/// Three chunks of columns, and some more.
const MAX_COLUMNS: usize = 70;
const MAX_ROWS: usize = 12;

/// A scan and how to segment it.
#[derive(Debug)]
pub struct Case {
    pub approach: Approach,
    pub settings: Settings,
    pub scan: Scan,
    /// Live labels that there is room for, 1 or more.
    pub areas: usize,
    /// The angles are those of some scanner: what rounding does to the points is as expected.
    pub usual_beams: bool,
}

/// A configuration of each approach, with the same ranging.
#[derive(Clone, Debug)]
pub struct Settings {
    pub ranging: Ranging,
    edge: EdgeConfig<'static>,
    traces: Vec<Trace>,
    pub region: RegionConfig,
}

impl Settings {
    pub fn plane(&self) -> PlaneConfig {
        PlaneConfig::new(self.ranging)
    }

    pub fn edge(&self) -> EdgeConfig<'_> {
        self.edge.with_traces(&self.traces)
    }

    pub fn config(&self, approach: Approach) -> AnyConfig<'_> {
        match approach {
            Approach::Plane => self.plane().into(),
            Approach::Edge => self.edge().into(),
            Approach::Region => self.region.into(),
        }
    }
}

/// All approaches.
pub const APPROACHES: [Approach; 3] = [Approach::Plane, Approach::Edge, Approach::Region];

impl Case {
    /// Whether every row can be taken by a segmenter of this configuration.
    pub fn is_taken(&self) -> bool {
        let refused = self.refused(self.settings.config(self.approach));
        refused.is_none() && self.scan.turn_rad.iter().all(|turn_rad| (-6300.0..=6300.0).contains(turn_rad))
    }

    /// Why there is no segmenter of a configuration for the scan; None if there is one.
    pub fn refused(&self, config: AnyConfig<'_>) -> Option<ConfigError> {
        let mut room = Room::new(self.scan.columns, config, self.areas);
        AnySegmenter::new(config, self.scan.beams(), self.scan.columns, room.memory()).err()
    }

    /// Room for every label.
    pub fn is_roomy(&self) -> bool {
        self.areas >= live_labels(self.scan.columns)
    }
}

impl Arbitrary<'_> for Case {
    fn arbitrary(u: &mut Unstructured) -> Result<Case> {
        let approach = APPROACHES[usize::from(u.arbitrary::<u8>()? % 3)];
        let settings = Settings::arbitrary(u)?;
        let columns = usize::from(u.arbitrary::<u8>()?) % (MAX_COLUMNS + 1);
        let rows = usize::from(u.arbitrary::<u8>()?) % (MAX_ROWS + 1);
        let all = live_labels(columns);
        let areas = if u.ratio(2u8, 3u8)? { all } else { 1 + usize::from(u.arbitrary::<u8>()?) % all };
        let mut usual_beams = true;
        let kind: u8 = u.arbitrary()?;
        let scan = if kind.is_multiple_of(8) && columns > 0 {
            let [rig, scene] = u.arbitrary::<[u8; 2]>()?.map(usize::from);
            scan_of(rows, columns, rig % 7, scene % 6, u.arbitrary::<u16>()?.into())
        } else {
            let mut angles = Numbers { u, usual: &mut usual_beams };
            let rig = rig(&mut angles, kind, columns)?;
            let turn_rad = turns(&mut angles, rows)?;
            let mut scan = Scan { columns, range_m: vec![0.0; rows * columns], turn_rad, rig };
            draw(u, &mut scan)?;
            scan
        };
        Ok(Case { approach, settings, scan, areas, usual_beams })
    }
}

/// Numbers that are mostly usual ones.
struct Numbers<'a, 'b, 'u> {
    u: &'a mut Unstructured<'u>,
    /// Cleared by a number that is not.
    usual: &'b mut bool,
}

impl Numbers<'_, '_, '_> {
    fn one_of(&mut self, usual: &[f32]) -> Result<f32> {
        let choice: u8 = self.u.arbitrary()?;
        if choice < 240 {
            return Ok(usual[usize::from(choice) % usual.len()]);
        }
        *self.usual = false;
        Ok(f32::from_bits(self.u.arbitrary()?))
    }
}

impl Arbitrary<'_> for Settings {
    fn arbitrary(u: &mut Unstructured) -> Result<Settings> {
        let mut numbers = Numbers { u, usual: &mut true };
        let ranging = Ranging::new(numbers.one_of(&[0.01, 0.0, 0.002, 0.3])?)
            .with_limits(numbers.one_of(&[0.05, 1.0, 1e-6])?, numbers.one_of(&[100.0, 5.0, 500.0])?);
        let edge = EdgeConfig::paper()
            .with_ranging(ranging)
            .with_roof_angle_rad(numbers.one_of(&[20f32.to_radians(), 4f32.to_radians(), 1.0, PI])?)
            .with_step_angle_rad(numbers.one_of(&[6f32.to_radians(), 0.0, 0.5, FRAC_PI_2])?)
            .with_closing(if numbers.u.arbitrary()? { Element::Square } else { Element::Plus });
        let region = RegionConfig::paper()
            .with_ranging(ranging)
            .with_line_angle_rad(numbers.one_of(&[3f32.to_radians(), 10f32.to_radians(), 0.8, FRAC_PI_2])?)
            .with_plane_distance_m(numbers.one_of(&[0.005, 0.0, 0.05, 1.0])?);
        let mut traces = vec![Trace::ROW, Trace::COLUMN];
        if u.ratio(1u8, 2u8)? {
            traces.resize(usize::from(u.arbitrary::<u8>()? % 10), Trace::DIAGONAL);
            for trace in &mut traces {
                *trace = Trace { rows: u.arbitrary::<u8>()? % 18, columns: u.arbitrary()? };
            }
        }
        Ok(Settings { ranging, edge, traces, region })
    }
}

fn rig(angles: &mut Numbers, kind: u8, columns: usize) -> Result<Rig> {
    let step_rad = angles.one_of(&[1f32.to_radians(), -(1f32.to_radians()), 0.1f32.to_radians(), 0.05])?;
    let start_rad = angles.one_of(&[-0.5, 0.0, -FRAC_PI_2, 3.0])?;
    let even = Angles::Even { start_rad, step_rad };
    let axis = if kind & 8 == 0 { TurnAxis::Y } else { TurnAxis::Z };
    Ok(match kind % 8 {
        1 | 2 => Rig::Nodding { angles: even, axis },
        3 => Rig::Nodding { angles: listed(angles, start_rad, step_rad, columns)?, axis },
        4 => {
            let step_rad = TAU.copysign(step_rad) / columns as f32;
            Rig::Spinning { angles: Angles::Even { start_rad, step_rad }, wraps: true }
        }
        5 => Rig::Spinning { angles: listed(angles, start_rad, step_rad, columns)?, wraps: kind & 8 == 0 },
        6 => Rig::Spinning { angles: even, wraps: false },
        _ => Rig::Pinhole {
            fx_px: angles.one_of(&[60.0, -60.0, 500.0])?,
            fy_px: angles.one_of(&[60.0, -50.0, 500.0])?,
            cx_px: angles.one_of(&[0.5 * columns as f32, 0.0, 100.0])?,
            cy_px: angles.one_of(&[6.0, 0.0, -100.0])?,
        },
    })
}

/// Columns a little out of place.
fn listed(angles: &mut Numbers, start_rad: f32, step_rad: f32, columns: usize) -> Result<Angles> {
    let jitter: u8 = angles.u.arbitrary()?;
    let mut list: Vec<f32> = (0..columns)
        .map(|c| start_rad + step_rad * (c as f32 + f32::from(jitter.rotate_left(c as u32)) / 512.0))
        .collect();
    if angles.u.ratio(1u8, 16u8)? {
        *angles.usual = false;
        // also of another length
        list.resize(columns + usize::from(angles.u.arbitrary::<u8>()?) % 2, 0.0);
        if let Some(angle) = list.last_mut() {
            *angle = f32::from_bits(angles.u.arbitrary()?);
        }
    }
    Ok(Angles::Listed(list))
}

/// Even turns, uneven ones, or any.
fn turns(angles: &mut Numbers, rows: usize) -> Result<Vec<f32>> {
    let step_rad = angles.one_of(&[1f32.to_radians(), -0.02, 0.002])?;
    let mut turn_rad = angles.one_of(&[0.0, -0.5, 9.0])?;
    let uneven: bool = angles.u.arbitrary()?;
    let turn = |_| {
        let now = turn_rad;
        turn_rad += if uneven { step_rad * f32::from(angles.u.arbitrary::<u8>()?) / 64.0 } else { step_rad };
        Ok(now)
    };
    (0..rows).map(turn).collect()
}

/// Ranges, pixel by pixel: a byte chooses one of four planes and the noise, or what is no range. A
/// row may repeat the bytes of the row above.
fn draw(u: &mut Unstructured, scan: &mut Scan) -> Result<()> {
    let mut planes = [[1.0, 0.0, 0.0, 2.0]; 4];
    for [x, y, z, distance_m] in &mut planes {
        let part = |byte: i8| f64::from(byte) / 64.0;
        (*x, *y, *z) = (1.0 + part(u.arbitrary()?), part(u.arbitrary()?), part(u.arbitrary()?));
        *distance_m = 0.3 + f64::from(u.arbitrary::<u8>()?) / 32.0;
    }
    let noise_m = [0.0, 0.001, 0.01, 0.1][usize::from(u.arbitrary::<u8>()? % 4)];
    let lists_all = match &scan.rig {
        Rig::Nodding { angles: Angles::Listed(list), .. } | Rig::Spinning { angles: Angles::Listed(list), .. } => {
            list.len() == scan.columns
        }
        _ => true,
    };
    let beams = lists_all.then(|| scan.reference_beams());
    let mut bytes = vec![0; scan.columns];
    for row in 0..scan.turn_rad.len() {
        if u.ratio(1u8, 2u8)? {
            u.fill_buffer(&mut bytes)?;
        }
        for (column, &byte) in bytes.iter().enumerate() {
            let range_m = &mut scan.range_m[row * scan.columns + column];
            *range_m = match byte {
                255 => f32::from_bits(u.arbitrary()?),
                248..=254 => [f32::NAN, f32::INFINITY, 0.0, -0.0, -2.0, 1e-30, 500.0][usize::from(byte - 248)],
                _ => {
                    let [x, y, z, distance_m] = planes[usize::from(byte % 4)];
                    let direction = beams.as_ref().map_or([1.0, 0.0, 0.0], |b| b.direction((row, column)).into());
                    let cos = x * direction[0] + y * direction[1] + z * direction[2];
                    let noise = f64::from(byte / 4) - 31.0;
                    (distance_m / cos + noise_m * noise / 16.0) as f32
                }
            };
        }
    }
    Ok(())
}
