//! Finds an LMS 2xx, sets it up, starts it, and starts over when it falls silent: a state machine without port or clock.

use super::command::{Answer, Command, CommandBytes, Configuration, POWER_ON, RESET_ANSWER};
use super::scan::{SCAN, Scan};
use super::settings::{Baud, Settings};
use super::telegram::{Decoder, Event, MAX_TELEGRAM, Telegram, TelegramError};
use super::trouble::Trouble;

/// Time within which the scanner acknowledges a command, when its line is free.
const ACKNOWLEDGE_MS: u32 = 60;
/// Pause between the tries of one command, and after the search has gone to another rate.
const PAUSE_MS: u32 = 25;
/// Pause after a change of the scanner's own rate.
const RATE_CHANGE_MS: u32 = 250;
/// No deadline is farther away: one that seems to be has passed while nobody polled, and the clock has wrapped.
const LONGEST_MS: u32 = 20_000;
/// Tries of a command before the session starts over, and of each rate while searching.
const TRIES: u8 = 3;
const FIND_TRIES: u8 = 2;

/// How far a session is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Phase {
    /// Trying the rates at which the scanner may listen.
    Finding,
    /// It answers, and is being set up.
    SettingUp,
    /// It sends scans.
    Running,
}

/// What the session asks its caller to do.
#[derive(Debug, Clone, Copy)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub enum Action {
    /// Set the port to this rate and drop what it has received.
    SetBaud(Baud),
    /// Send these bytes, with a pause of `gap_us` after each byte at [`Baud::B500000`] (elsewhere it is 0).
    Send {
        /// What to send.
        bytes: CommandBytes,
        /// Pause after each byte, microseconds.
        gap_us: u32,
    },
    /// Receive for at most so long; give what comes to [`Session::feed`], then poll again.
    Wait {
        /// Milliseconds, at least 1.
        ms: u32,
    },
    /// Nothing to do: something went wrong, and the session deals with it.
    Tell(Trouble),
}

/// What [`Session::feed`] met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SessionEvent {
    /// All bytes are used. Poll.
    NeedMore,
    /// A scan may be beginning, see [`Event::Start`]: read the tilt encoder now. Only while running.
    Start {
        /// Bytes between the start byte and the last byte used.
        bytes_ago: u16,
    },
    /// A scan as the settings say: [`Session::scan`] gives it until the next call of `feed` or `poll`.
    Scan,
    /// A damaged telegram, or one unlike the settings. Only while running.
    Rejected(TelegramError),
}

/// Commands in the order in which a session sends them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    /// Stops the scanner at whatever rate it answers.
    Find,
    SetBaud,
    SetVariant,
    ReadConfiguration,
    Install(Configuration),
    WriteConfiguration(Configuration),
    LeaveInstallation,
    Start,
}

#[derive(Debug, Clone, Copy)]
enum State {
    /// The caller must set the port to `Session::at`, then wait.
    Tune {
        settle_ms: u32,
    },
    /// What comes is dropped until then.
    Pause {
        until_ms: u32,
        then: Step,
    },
    Send(Step),
    Await {
        step: Step,
        deadline_ms: u32,
        acknowledged: bool,
    },
    Running {
        deadline_ms: u32,
    },
    Listening,
}

/// One scanner on one line. About 900 bytes; `new` is `const`, so that it can be made in place in a static.
///
/// Call [`Session::poll`], do what it says, and give received bytes to [`Session::feed`], both with a millisecond clock of
/// any origin that wraps at 2^32. Every call does bounded work and returns at once.
#[derive(Debug, Clone)]
pub struct Session {
    settings: Settings,
    decoder: Decoder,
    state: State,
    /// Rate of the port.
    at: Baud,
    /// Rate at which the search began, and rates tried since.
    first: Baud,
    searched: u8,
    tries: u8,
    trouble: Option<Trouble>,
}

impl Session {
    /// A session that has not begun.
    #[must_use]
    pub const fn new(settings: Settings) -> Self {
        Self {
            settings,
            decoder: Decoder::new(),
            state: State::Tune { settle_ms: PAUSE_MS },
            at: settings.baud,
            first: settings.baud,
            searched: 0,
            tries: 0,
            trouble: None,
        }
    }

    /// A session that sends nothing: for a scanner that was set up and started by others, or for bytes recorded from one.
    /// It is always [`Phase::Running`]. Scans of a part of the field of view (0xB7) are passed over.
    #[must_use]
    pub const fn listening(settings: Settings) -> Self {
        let mut session = Self::new(settings);
        session.state = State::Listening;
        session.decoder.expect_scans(Some(settings.format()));
        session
    }

    /// How far the session is.
    #[must_use]
    pub fn phase(&self) -> Phase {
        match self.state {
            State::Running { .. } | State::Listening => Phase::Running,
            State::Tune { .. } | State::Pause { then: Step::Find, .. } => Phase::Finding,
            State::Send(Step::Find) | State::Await { step: Step::Find, .. } => Phase::Finding,
            _ => Phase::SettingUp,
        }
    }

    /// The settings it was made with.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Rate that the port has now.
    #[must_use]
    pub fn baud(&self) -> Baud {
        self.at
    }

    /// The scan that the last `feed` reported.
    #[must_use]
    pub fn scan(&self) -> Option<Scan<'_>> {
        self.decoder.telegram()?.scan()
    }

    /// What to do now.
    pub fn poll(&mut self, now_ms: u32) -> Action {
        loop {
            if let Some(trouble) = self.trouble.take() {
                return Action::Tell(trouble);
            }
            match self.state {
                State::Tune { settle_ms } => {
                    self.pause(now_ms, settle_ms, Step::Find);
                    return Action::SetBaud(self.at);
                }
                State::Pause { until_ms, then } => {
                    if let Some(ms) = time_left(now_ms, until_ms) {
                        return Action::Wait { ms };
                    }
                    self.state = State::Send(then);
                }
                State::Send(step) => return self.send(now_ms, step),
                State::Await { step, deadline_ms, .. } => {
                    if let Some(ms) = time_left(now_ms, deadline_ms) {
                        return Action::Wait { ms };
                    }
                    if !self.found_late(now_ms) {
                        self.failed(now_ms, step, Trouble::NoAnswer { command: self.command(step).code() });
                    }
                }
                State::Listening => return Action::Wait { ms: 1000 },
                State::Running { deadline_ms } => {
                    if let Some(ms) = time_left(now_ms, deadline_ms) {
                        return Action::Wait { ms };
                    }
                    self.start_over(Trouble::Silent);
                }
            }
        }
    }

    /// Takes received bytes up to the next event; returns how many were used and what happened. Feed the rest again, even if
    /// it is empty, until [`SessionEvent::NeedMore`].
    pub fn feed(&mut self, now_ms: u32, input: &[u8]) -> (usize, SessionEvent) {
        let mut used = 0;
        loop {
            if matches!(self.state, State::Tune { .. } | State::Pause { .. }) {
                return (input.len(), SessionEvent::NeedMore);
            }
            let fed = self.decoder.feed(input.get(used..).unwrap_or(&[]));
            used += fed.used;
            if fed.event == Event::NeedMore {
                return (used, SessionEvent::NeedMore);
            }
            if let Some(event) = self.handle(now_ms, fed.event) {
                return (used, event);
            }
        }
    }

    fn handle(&mut self, now_ms: u32, event: Event) -> Option<SessionEvent> {
        if let Event::Telegram { code: POWER_ON | RESET_ANSWER } = event {
            self.start_over(Trouble::Restarted);
            return None;
        }
        match (self.state, event) {
            (State::Listening, Event::Telegram { code: SCAN }) => return Some(SessionEvent::Scan),
            (State::Running { .. } | State::Listening, Event::Start { bytes_ago }) => {
                return Some(SessionEvent::Start { bytes_ago });
            }
            (State::Running { .. }, Event::Telegram { code: SCAN }) => {
                self.state = State::Running { deadline_ms: now_ms.wrapping_add(self.scan_timeout_ms()) };
                return Some(SessionEvent::Scan);
            }
            (State::Running { .. } | State::Listening, Event::Rejected(error)) => {
                // On a bad line good scans may be rare, but one with a good head is a sign of life.
                if let (State::Running { .. }, TelegramError::CheckWord { .. }) = (self.state, error) {
                    self.state = State::Running { deadline_ms: now_ms.wrapping_add(self.scan_timeout_ms()) };
                }
                return Some(SessionEvent::Rejected(error));
            }
            (State::Await { step, acknowledged: false, .. }, Event::Ack) => {
                let deadline_ms = now_ms.wrapping_add(answer_ms(step) + telegram_ms(self.at));
                self.state = State::Await { step, deadline_ms, acknowledged: true };
            }
            // At a wrong rate, or within a running scan, any byte comes up: while searching a NACK says nothing.
            (State::Await { step, acknowledged: false, .. }, Event::Nack) if step != Step::Find => {
                self.failed(now_ms, step, Trouble::NotAcknowledged { command: self.command(step).code() });
            }
            // The answer was lost but the scans are there.
            (State::Await { step: Step::Start, .. }, Event::Telegram { code: SCAN }) => {
                self.advance(now_ms, Step::Start);
                return Some(SessionEvent::Scan);
            }
            (State::Await { step, .. }, Event::Telegram { .. }) => {
                match self.decoder.telegram().and_then(|telegram| self.command(step).answer(&telegram)) {
                    Some(Answer::Done) => self.advance(now_ms, step),
                    Some(Answer::Refused(reason)) => {
                        self.failed(now_ms, step, Trouble::Refused { command: self.command(step).code(), reason });
                    }
                    None => {}
                }
            }
            _ => {}
        }
        None
    }

    fn command(&self, step: Step) -> Command {
        match step {
            Step::Find | Step::LeaveInstallation => Command::Stop,
            Step::SetBaud => Command::SetBaud(self.settings.baud),
            Step::SetVariant => Command::SetVariant(self.settings.variant),
            Step::ReadConfiguration => Command::ReadConfiguration,
            Step::Install(_) => Command::Install,
            Step::WriteConfiguration(configuration) => Command::WriteConfiguration(configuration),
            Step::Start if self.settings.interlaced => Command::StartInterlaced,
            Step::Start => Command::Start,
        }
    }

    fn send(&mut self, now_ms: u32, step: Step) -> Action {
        let bytes = self.command(step).encode();
        let count = bytes.as_slice().len() as u32;
        let gap_us = self.at.gap_us();
        let sending_ms = (self.at.line_time_us(count) + gap_us * count).div_ceil(1000);
        // A scan may be under way and must come first.
        let deadline_ms = now_ms.wrapping_add(sending_ms + ACKNOWLEDGE_MS + telegram_ms(self.at));
        self.state = State::Await { step, deadline_ms, acknowledged: false };
        self.decoder.expect_scans((step == Step::Start).then(|| self.settings.format()));
        Action::Send { bytes, gap_us }
    }

    fn advance(&mut self, now_ms: u32, step: Step) {
        self.tries = 0;
        self.state = match step {
            Step::Find if self.at != self.settings.baud => State::Send(Step::SetBaud),
            Step::Find => State::Send(Step::SetVariant),
            Step::SetBaud => {
                self.search_from(self.settings.baud);
                State::Tune { settle_ms: RATE_CHANGE_MS }
            }
            Step::SetVariant => State::Send(Step::ReadConfiguration),
            Step::ReadConfiguration => {
                let data = self.decoder.telegram().map_or(&[][..], |telegram: Telegram<'_>| telegram.data());
                let Some(found) = Configuration::new(data) else {
                    let length = data.len() as u16;
                    return self.start_over(Trouble::Configuration { length });
                };
                let wanted = found.with(self.settings.mode, self.settings.unit);
                State::Send(if wanted == found { Step::Start } else { Step::Install(wanted) })
            }
            Step::Install(wanted) => State::Send(Step::WriteConfiguration(wanted)),
            Step::WriteConfiguration(_) => State::Send(Step::LeaveInstallation),
            Step::LeaveInstallation => State::Send(Step::Start),
            Step::Start => State::Running { deadline_ms: now_ms.wrapping_add(self.scan_timeout_ms()) },
        };
    }

    /// A try of this step has failed.
    fn failed(&mut self, now_ms: u32, step: Step, trouble: Trouble) {
        self.tries += 1;
        // An EEPROM write is not repeated blindly: the session starts over and reads first what the scanner has.
        let tries = match step {
            Step::WriteConfiguration(_) => 1,
            Step::Find => FIND_TRIES,
            _ => TRIES,
        };
        if self.tries < tries {
            self.pause(now_ms, PAUSE_MS, step);
        } else if step == Step::Find {
            self.next_rate();
        } else {
            self.start_over(trouble);
        }
    }

    fn start_over(&mut self, trouble: Trouble) {
        self.trouble = Some(trouble);
        if matches!(self.state, State::Listening) {
            return;
        }
        self.search_from(self.at);
        self.state = State::Tune { settle_ms: PAUSE_MS };
    }

    fn search_from(&mut self, rate: Baud) {
        self.tries = 0;
        self.at = rate;
        self.first = rate;
        self.searched = 0;
    }

    /// On to the next rate: the first, then all others, then again.
    fn next_rate(&mut self) {
        self.tries = 0;
        loop {
            let rate = Baud::ALL.get(usize::from(self.searched)).copied();
            self.searched += 1;
            match rate {
                Some(rate) if rate == self.first => {}
                Some(rate) => {
                    self.at = rate;
                    break;
                }
                None => {
                    self.trouble = Some(Trouble::NotFound);
                    self.search_from(self.settings.baud);
                    break;
                }
            }
        }
        self.state = State::Tune { settle_ms: PAUSE_MS };
    }

    fn pause(&mut self, now_ms: u32, ms: u32, then: Step) {
        self.decoder.clear();
        self.state = State::Pause { until_ms: now_ms.wrapping_add(ms), then };
    }

    /// The deadline has passed. A false start byte may have hidden the answer: looks at all bytes held once more, and tells
    /// whether that got the session on.
    fn found_late(&mut self, now_ms: u32) -> bool {
        while matches!(self.state, State::Await { .. }) && self.decoder.expire().is_some() {
            while matches!(self.state, State::Await { .. }) {
                match self.decoder.feed(&[]).event {
                    Event::NeedMore => break,
                    event => _ = self.handle(now_ms, event),
                }
            }
        }
        !matches!(self.state, State::Await { .. })
    }

    /// Three scans' time at this rate, and half a second in which the scanner may be busy.
    fn scan_timeout_ms(&self) -> u32 {
        500 + 3 * (14 * u32::from(self.settings.variant.turns()) + telegram_ms(self.at))
    }
}

/// Time of the longest telegram on the line.
fn telegram_ms(rate: Baud) -> u32 {
    rate.line_time_us(MAX_TELEGRAM as u32).div_ceil(1000)
}

/// Time from acknowledgement to answer: modes take up to 3 s, EEPROM writes up to 15 s.
fn answer_ms(step: Step) -> u32 {
    match step {
        Step::Find | Step::ReadConfiguration => 1000,
        Step::WriteConfiguration(_) => 15_000,
        Step::SetBaud | Step::SetVariant | Step::Install(_) | Step::LeaveInstallation | Step::Start => 3000,
    }
}

fn time_left(now_ms: u32, until_ms: u32) -> Option<u32> {
    let left = until_ms.wrapping_sub(now_ms);
    (left != 0 && left <= LONGEST_MS).then_some(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Who has not polled for weeks need not wait for weeks more, wherever the clock is by then.
    #[test]
    fn away_for_weeks() {
        use crate::lms2xx::{MeasuringMode, Unit, Variant};
        let settings = Settings {
            baud: Baud::B9600,
            variant: Variant::Deg100Step025,
            unit: Unit::Centimetre,
            mode: MeasuringMode::Range8Fields,
            interlaced: false,
        };
        for away_ms in [1000, (1 << 31) - 1, 1 << 31, (1 << 31) + 100, u32::MAX - LONGEST_MS] {
            let mut session = Session::new(settings);
            assert!(matches!(session.poll(7), Action::SetBaud(_)));
            assert!(matches!(session.poll(7), Action::Wait { ms: PAUSE_MS }));
            assert!(matches!(session.poll(away_ms.wrapping_add(7 + PAUSE_MS)), Action::Send { .. }), "{away_ms}");
        }
        let configuration = Configuration::new(&[0; 32]).expect("a configuration");
        let longest_ms = answer_ms(Step::WriteConfiguration(configuration)) + telegram_ms(Baud::B9600);
        assert!(longest_ms <= LONGEST_MS && Session::new(settings).scan_timeout_ms() <= LONGEST_MS);
    }

    #[test]
    fn size() {
        assert!(size_of::<Decoder>() < 900 && size_of::<Session>() < 1024);
    }
}
