//! What goes wrong on a virtual rig, and when.

use scanseg_core::Segmenter;
use scanseg_hal::lms2xx::Phase;
use scanseg_virtual_rig::{Chain, EncoderFault, WireFaults};

/// How long an encoder sticks.
const STUCK_US: u64 = 1_000_000;

/// A value of the option.
#[derive(Clone, Copy)]
pub enum Fault {
    /// One in so many bytes.
    Loss(u32),
    Flip(u32),
    Insert(u32),
    /// Times, microseconds.
    Reset(u64),
    Stuck(u64),
}

/// All that goes wrong.
#[derive(Default)]
pub struct Faults {
    pub wires: WireFaults,
    /// When the scanner's power fails.
    resets_us: Vec<u64>,
    /// When the encoder sticks, at the earliest.
    sticks_us: Vec<u64>,
    /// Until when it sticks now.
    stuck_until_us: Option<u64>,
}

impl Faults {
    pub fn new(faults: &[Fault]) -> Faults {
        let mut all = Faults::default();
        for fault in faults {
            match *fault {
                Fault::Loss(one_in) => all.wires.drop_one_in = one_in,
                Fault::Flip(one_in) => all.wires.flip_one_in = one_in,
                Fault::Insert(one_in) => all.wires.insert_one_in = one_in,
                Fault::Reset(at_us) => all.resets_us.push(at_us),
                Fault::Stuck(at_us) => all.sticks_us.push(at_us),
            }
        }
        all
    }

    /// Does to the chain what is due by now. An encoder that sticks while no row comes would not
    /// show, so that it waits for the scanner to run.
    pub fn strike(&mut self, chain: &mut Chain<'_, impl Segmenter>) {
        let now_us = chain.now_us();
        while let Some(at) = self.resets_us.iter().position(|&at_us| at_us <= now_us) {
            self.resets_us.swap_remove(at);
            chain.lms.power_cycle(now_us);
        }
        self.stuck_until_us = self.stuck_until_us.filter(|&until_us| now_us < until_us);
        if self.stuck_until_us.is_none()
            && chain.phase() == Phase::Running
            && let Some(at) = self.sticks_us.iter().position(|&at_us| at_us <= now_us)
        {
            self.sticks_us.swap_remove(at);
            self.stuck_until_us = Some(now_us + STUCK_US);
        }
        let stuck = self.stuck_until_us.is_some();
        chain.encoder_fault = if stuck { EncoderFault::Stuck } else { EncoderFault::None };
    }

    /// Returns whether all has gone wrong that should, at its time.
    pub fn are_over(&self) -> bool {
        self.resets_us.is_empty() && self.sticks_us.is_empty() && self.stuck_until_us.is_none()
    }
}

/// `loss=0.001`.
pub fn parse_fault(text: &str) -> Result<Fault, String> {
    let names = "loss=RATE, flip=RATE, insert=RATE, reset=SECONDS or stuck=SECONDS";
    let (name, number) = text.split_once('=').ok_or(format!("not {names}"))?;
    let value: f64 = number.parse().map_err(|_| format!("`{number}` is not a number"))?;
    let one_in = match 1e-9..=0.5 {
        rates if rates.contains(&value) => Ok((1.0 / value).round() as u32),
        _ => Err(format!("a rate of {value} is not within 1e-9 and 0.5")),
    };
    let at_us = match 0.0..=600.0 {
        times if times.contains(&value) => Ok((1e6 * value) as u64),
        _ => Err(format!("a time of {value} s is not within 0 and 600")),
    };
    Ok(match name {
        "loss" => Fault::Loss(one_in?),
        "flip" => Fault::Flip(one_in?),
        "insert" => Fault::Insert(one_in?),
        "reset" => Fault::Reset(at_us?),
        "stuck" => Fault::Stuck(at_us?),
        _ => return Err(format!("`{name}` is not {names}")),
    })
}
