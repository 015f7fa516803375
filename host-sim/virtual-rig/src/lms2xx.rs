//! An LMS 2xx on a simulated serial line.

use std::collections::VecDeque;

use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Unit, Variant};

use crate::measurement::{Beam, MirrorTurn};
use crate::mode::{Mode, ModeChange};
use crate::telegrams::frame;
use crate::wires::Wires;

/// Time from switching on to the power-on message.
const BOOT_US: u64 = 4_000_000;
/// Time from a command to its acknowledgement.
const ACKNOWLEDGE_US: u64 = 8_000;
/// Deafness after a change of the rate.
const RATE_CHANGE_US: u64 = 200_000;
/// Silence within a command after which the scanner forgets what it has of it.
const COMMAND_PAUSE_US: u64 = 20_000;
/// At 500 000 Bd, a byte that ends sooner than this after the one before is lost: 55 us of silence
/// and its own 20.
const FAST_BYTE_US: u64 = 75;
const TYPE: &[u8] = b"LMS200;301063;V02.10 ";

/// What the scanner does wrong with a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mishap {
    /// Nothing.
    None,
    /// Acts as if it had not been sent.
    Ignore,
    /// Answers NACK and does nothing.
    Nack,
    /// Does it and answers, but does not acknowledge.
    NoAcknowledge,
    /// Acknowledges and does it, but does not answer.
    NoAnswer,
    /// Acknowledges, does nothing, and says so.
    Refuse,
    /// Acknowledges, does nothing, and answers "incorrect command".
    Misunderstand,
    /// Acknowledges, does nothing, and sends the answer to some other command.
    WrongAnswer,
}

/// What is done when an answer has gone out.
#[derive(Clone, Copy, Debug)]
enum After {
    Nothing,
    Rate(Baud),
    Reboot,
}

/// An LMS 2xx at the end of a serial line. Times are microseconds since the start of the
/// simulation, and never fall from call to call. It is switched on at 0.
pub struct VirtualLms {
    ranges: Box<dyn FnMut(Beam) -> u16>,
    baud: Baud,
    variant: Variant,
    mode: Mode,
    configuration: [u8; 34],
    /// Switched on or reset then; deaf and dumb until the power-on message.
    booting_until_us: Option<u64>,
    /// Bytes on their way to the scanner: when they arrive, and the rate they were sent at.
    coming: VecDeque<(u64, u8, Baud)>,
    last_came_us: u64,
    deaf_until_us: u64,
    command: Vec<u8>,
    /// Answers to be sent: from when, what, and what then.
    answers: VecDeque<(u64, Vec<u8>, After)>,
    rate_change: Option<(u64, Baud)>,
    /// Mirror turns done.
    turns: u64,
    /// Turns since the scanner was started.
    turns_running: u64,
    /// Bytes on their way to the host.
    going: VecDeque<(u64, u8, Baud)>,
    line_free_us: u64,
    /// The wires to and from it.
    pub wires: Wires,
    /// What goes wrong with the next commands that arrive whole, in order.
    pub mishaps: VecDeque<Mishap>,
    /// Rate after switching on.
    pub permanent_baud: Baud,
    /// Writes of the EEPROM so far.
    pub eeprom_writes: u32,
    /// Commands that arrived whole so far, by their code.
    pub commands: Vec<u8>,
    /// Scans put on the line so far.
    pub scans_sent: u32,
}

impl VirtualLms {
    /// Returns a scanner that measures what `ranges` says, in counts of whatever unit is
    /// configured. As delivered: 9600 Bd, 100 degrees in steps of 1 degree, centimetres, 8 m
    /// measuring mode.
    #[must_use]
    pub fn new(ranges: impl FnMut(Beam) -> u16 + 'static) -> Self {
        let mut configuration = [0; 34];
        (configuration[2], configuration[9], configuration[10]) = (0x46, 2, 2);
        Self {
            ranges: Box::new(ranges),
            baud: Baud::B9600,
            variant: Variant::Deg100Step1,
            mode: Mode::Idle,
            configuration,
            booting_until_us: Some(BOOT_US),
            coming: VecDeque::new(),
            last_came_us: 0,
            deaf_until_us: 0,
            command: Vec::new(),
            answers: VecDeque::new(),
            rate_change: None,
            turns: 0,
            turns_running: 0,
            going: VecDeque::new(),
            line_free_us: 0,
            wires: Wires::default(),
            mishaps: VecDeque::new(),
            permanent_baud: Baud::B9600,
            eeprom_writes: 0,
            commands: Vec::new(),
            scans_sent: 0,
        }
    }

    /// Returns it as if it had been found running: past its start, at this rate, sending complete
    /// scans of this variant.
    #[must_use]
    pub fn running(mut self, baud: Baud, variant: Variant) -> Self {
        self.booting_until_us = None;
        (self.baud, self.variant, self.mode) = (baud, variant, Mode::Complete);
        self
    }

    /// Returns it as if this measuring mode and unit were in its EEPROM.
    #[must_use]
    pub fn configured(mut self, mode: MeasuringMode, unit: Unit) -> Self {
        (self.configuration[5], self.configuration[6]) = (mode.code(), unit.code());
        self
    }

    /// Returns measuring mode and unit as its EEPROM has them, by their codes.
    #[must_use]
    pub fn mode_and_unit(&self) -> (u8, u8) {
        (self.configuration[5], self.configuration[6])
    }

    /// Returns whether it sends scans.
    #[must_use]
    pub fn is_scanning(&self) -> bool {
        !matches!(self.mode, Mode::Idle | Mode::Install)
    }

    /// Puts these bytes on its line, one right after the other from `now_us` on. Returns when the
    /// last has gone.
    pub fn write(&mut self, now_us: u64, bytes: &[u8], baud: Baud) -> u64 {
        let mut time_us = now_us;
        for &byte in bytes {
            time_us += u64::from(baud.line_time_us(1));
            for byte in self.wires.damage(byte) {
                self.coming.push_back((time_us, byte, baud));
            }
        }
        time_us
    }

    /// Returns what has come from it by `now_us`, to a port that listens at this rate.
    pub fn read(&mut self, now_us: u64, baud: Baud) -> Vec<u8> {
        self.advance(now_us);
        let mut bytes = Vec::new();
        while let Some(&(time_us, byte, sent_at)) = self.going.front()
            && time_us <= now_us
        {
            self.going.pop_front();
            if let Some(byte) = self.wires.garble(byte, sent_at, baud) {
                bytes.extend(self.wires.damage(byte));
            }
        }
        bytes
    }

    /// Its power fails and comes back at once.
    pub fn power_cycle(&mut self, now_us: u64) {
        self.advance(now_us);
        self.booting_until_us = Some(now_us + BOOT_US);
        self.baud = self.permanent_baud;
        self.variant = Variant::Deg100Step1;
        self.mode = Mode::Idle;
        self.command.clear();
        self.answers.clear();
        self.going.clear();
        self.rate_change = None;
        self.line_free_us = now_us;
    }

    /// It stops sending without being told to.
    pub fn fall_silent(&mut self, now_us: u64) {
        self.advance(now_us);
        self.mode = Mode::Idle;
    }

    /// Runs up to `now_us`, event by event.
    fn advance(&mut self, now_us: u64) {
        loop {
            let boot = self.booting_until_us.unwrap_or(u64::MAX);
            let byte = self.coming.front().map_or(u64::MAX, |&(time_us, ..)| time_us);
            let answer = self.answers.front().map_or(u64::MAX, |&(time_us, ..)| time_us);
            let rate = self.rate_change.map_or(u64::MAX, |(time_us, _)| time_us);
            // 75 turns a second.
            let turn = (self.turns + 1) * 40_000 / 3;
            let next = boot.min(byte).min(answer).min(rate).min(turn);
            if next > now_us {
                return;
            }
            if next == rate {
                self.baud = self.rate_change.take().expect("there is one").1;
                self.deaf_until_us = next + RATE_CHANGE_US;
            } else if next == boot {
                self.booting_until_us = None;
                self.send(next, &[&[0x90], TYPE].concat());
            } else if next == answer {
                let (_, bytes, after) = self.answers.pop_front().expect("there is one");
                self.put(next, &bytes);
                match after {
                    After::Nothing => {}
                    After::Rate(baud) => self.rate_change = Some((self.line_free_us, baud)),
                    After::Reboot => {
                        self.mode = Mode::Idle;
                        self.booting_until_us = Some(self.line_free_us + BOOT_US);
                        self.rate_change = Some((self.line_free_us, self.permanent_baud));
                    }
                }
            } else if next == byte {
                let (time_us, byte, sent_at) = self.coming.pop_front().expect("there is one");
                let deaf = self.booting_until_us.is_some() || time_us < self.deaf_until_us;
                if let Some(byte) = self.wires.garble(byte, sent_at, self.baud)
                    && !deaf
                {
                    self.receive(time_us, byte);
                }
            } else {
                self.turns += 1;
                self.mirror_turned(next);
            }
        }
    }

    fn receive(&mut self, time_us: u64, byte: u8) {
        let pause_us = time_us - self.last_came_us;
        self.last_came_us = time_us;
        if pause_us > COMMAND_PAUSE_US {
            self.command.clear();
        } else if self.baud == Baud::B500000 && pause_us < FAST_BYTE_US {
            return;
        }
        self.command.push(byte);
        if !self.command.starts_with(&[0x02, 0x00][..self.command.len().min(2)]) {
            self.command.clear();
            return;
        }
        let &[_, _, low, high, ..] = &self.command[..] else { return };
        let length = 4 + usize::from(u16::from_le_bytes([low, high])) + 2;
        if length > 64 {
            self.command.clear();
        } else if self.command.len() == length {
            let command = core::mem::take(&mut self.command);
            let (covered, check) = command.split_at(length - 2);
            let mishap = self.mishaps.pop_front().unwrap_or(Mishap::None);
            if check_word(covered).to_le_bytes() != check || mishap == Mishap::Nack {
                self.answers.push_back((time_us + ACKNOWLEDGE_US, vec![0x15], After::Nothing));
            } else if mishap != Mishap::Ignore && length > 6 {
                self.obey(time_us, &covered[4..], mishap);
            }
        }
    }

    fn obey(&mut self, time_us: u64, payload: &[u8], mishap: Mishap) {
        self.commands.push(payload[0]);
        if mishap != Mishap::NoAcknowledge {
            self.answers.push_back((time_us + ACKNOWLEDGE_US, vec![0x06], After::Nothing));
        }
        let undone = matches!(mishap, Mishap::Refuse | Mishap::Misunderstand | Mishap::WrongAnswer);
        let (delay_us, mut answer, mut after) = if undone {
            let fail = if payload[0] == 0x20 { 1 } else { 0 };
            (20_000, [&[payload[0] + 0x80, fail][..], &payload[1..]].concat(), After::Nothing)
        } else {
            self.carry_out(payload)
        };
        match mishap {
            Mishap::Misunderstand => answer = vec![0x92],
            Mishap::WrongAnswer => answer = [&[0xBA], TYPE].concat(),
            Mishap::NoAnswer => answer.clear(),
            _ => {}
        }
        if answer.is_empty() {
            if let After::Rate(baud) = core::mem::replace(&mut after, After::Nothing) {
                self.rate_change = Some((time_us + delay_us, baud));
            }
        } else {
            answer.push(0x10);
            self.answers.push_back((time_us + ACKNOWLEDGE_US + delay_us, frame(&answer), after));
        }
    }

    /// Does what the command says: after how long it answers, with what (code and data), and what
    /// then.
    fn carry_out(&mut self, payload: &[u8]) -> (u64, Vec<u8>, After) {
        let mut after = After::Nothing;
        let (delay_us, answer) = match payload {
            [0x10] => {
                after = After::Reboot;
                (10_000, vec![0x91])
            }
            [0x20, data @ ..] => {
                let change = ModeChange::parse(data, self.variant.columns());
                match change {
                    Some(ModeChange::Mode(mode)) => self.mode = mode,
                    Some(ModeChange::Rate(baud)) => after = After::Rate(baud),
                    None => {}
                }
                self.turns_running = 0;
                (100_000, vec![0xA0, u8::from(change.is_none())])
            }
            [0x3B, rest @ ..] => {
                let variant = Variant::ALL.into_iter().find(|variant| {
                    rest == [variant.view_deg().to_le_bytes(), variant.step_cdeg().to_le_bytes()].as_flattened()
                });
                self.variant = variant.unwrap_or(self.variant);
                (500_000, [&[0xBB, u8::from(variant.is_some())], rest].concat())
            }
            [0x74] => (20_000, [&[0xF4], &self.configuration[..]].concat()),
            [0x77, rest @ ..] => {
                let written = self.mode == Mode::Install && rest.len() == self.configuration.len();
                if written {
                    self.configuration.copy_from_slice(rest);
                    self.eeprom_writes += 1;
                }
                (4_000_000, [&[0xF7, u8::from(written)], &self.configuration[..]].concat())
            }
            // The scan is the answer.
            [0x30, 0x01] => {
                (self.mode, self.turns_running) = (Mode::Once, 0);
                (0, vec![])
            }
            // Version, mode, and 143 bytes more, of which nothing is known here.
            [0x31] => {
                let mode = if self.is_scanning() { 0x24 } else { 0x25 };
                (10_000, [&[0xB1], &b"V02.10 "[..], &[mode], &[0; 143]].concat())
            }
            [0x32] => (10_000, vec![0xB2, 0, 0]),
            [0x3A] => (10_000, [&[0xBA], TYPE].concat()),
            _ => (10_000, vec![0x92]),
        };
        (delay_us, answer, after)
    }

    /// A turn of the mirror has ended.
    fn mirror_turned(&mut self, now_us: u64) {
        if !self.is_scanning() || self.booting_until_us.is_some() {
            return;
        }
        let turn = MirrorTurn {
            end_us: now_us,
            number: self.turns_running % u64::from(self.variant.mirror_turns()),
            mode: self.mode,
            variant: self.variant,
            unit_code: self.configuration[6],
        };
        self.turns_running += 1;
        // What cannot be sent at once is not sent at all.
        if !turn.completes_scan() || self.line_free_us > now_us || !self.answers.is_empty() {
            return;
        }
        let payload = turn.scan_payload(&mut self.ranges);
        self.scans_sent += 1;
        if self.mode == Mode::Once {
            self.mode = Mode::Idle;
        }
        self.put(now_us, &frame(&payload));
    }

    /// Sends a telegram of code and data.
    fn send(&mut self, now_us: u64, payload: &[u8]) {
        self.put(now_us, &frame(&[payload, &[0x10]].concat()));
    }

    /// Puts bytes on the line as soon as it is free.
    fn put(&mut self, now_us: u64, bytes: &[u8]) {
        let from_us = self.line_free_us.max(now_us);
        for (sent, &byte) in (1..).zip(bytes) {
            self.going.push_back((from_us + u64::from(self.baud.line_time_us(sent)), byte, self.baud));
        }
        self.line_free_us = from_us + u64::from(self.baud.line_time_us(bytes.len() as u32));
    }
}
