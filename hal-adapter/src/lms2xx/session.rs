//! A session with an LMS 2xx: finds it, sets it up, starts it, and starts over when it falls
//! silent. It needs no port and no clock.

use super::action::{Action, Phase, SessionEvent};
use super::command::{Answer, Command, Configuration, POWER_ON, RESET_ANSWER};
use super::scan_line::{MEANS, SCAN_LINE, SUB_RANGE, ScanLine};
use super::settings::{Baud, Settings};
use super::step::Step;
use super::telegram::{Event, MAX_TELEGRAM, Telegram, TelegramDecoder, TelegramError};
use super::trouble::Trouble;

/// Time within which the scanner acknowledges a command while it sends nothing.
const ACKNOWLEDGE_MS: u32 = 60;
/// Pause between two tries of a command, and after a change to another rate in the search.
const PAUSE_MS: u32 = 25;
/// Pause after a change of the scanner's own rate.
const RATE_CHANGE_MS: u32 = 250;
/// The longest time to a deadline. A deadline that seems farther away has passed long ago: the
/// clock has wrapped since.
const LONGEST_MS: u32 = 20_000;

/// What a session is doing.
#[derive(Clone, Copy, Debug)]
enum State {
    /// The caller must set the port to `Session::at`, then wait.
    Tune {
        settle_ms: u32,
    },
    /// Bytes received are dropped until then.
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

/// A session with one scanner. About 900 bytes; `new` is `const`, so that it can be made in a
/// static.
///
/// Call [`Session::poll`], do the [`Action`] that it returns, and give received bytes to
/// [`Session::feed`]. Both take the time in milliseconds from an arbitrary origin; it wraps at
/// 2^32. The work of every call is bounded, and none waits.
#[derive(Clone, Debug)]
pub struct Session {
    settings: Settings,
    decoder: TelegramDecoder,
    state: State,
    /// Rate of the port.
    at: Baud,
    /// Rate at which the search began, and number of rates tried since.
    first: Baud,
    searched: u8,
    tries: u8,
    trouble: Option<Trouble>,
}

impl Session {
    /// Returns a session that has not begun.
    #[must_use]
    pub const fn new(settings: Settings) -> Self {
        Self {
            settings,
            decoder: TelegramDecoder::new(),
            state: State::Tune { settle_ms: PAUSE_MS },
            at: settings.baud,
            first: settings.baud,
            searched: 0,
            tries: 0,
            trouble: None,
        }
    }

    /// Returns a session that sends nothing: for a scanner that has been set up and started
    /// already, or for recorded bytes. It is always [`Phase::Running`].
    #[must_use]
    pub const fn listening(settings: Settings) -> Self {
        let mut session = Self::new(settings);
        session.state = State::Listening;
        session.decoder.expect_scan_lines(Some(settings.format()));
        session
    }

    /// Returns the phase.
    #[must_use]
    pub fn phase(&self) -> Phase {
        match self.state {
            State::Running { .. } | State::Listening => Phase::Running,
            State::Tune { .. } | State::Pause { then: Step::Find, .. } => Phase::Finding,
            State::Send(Step::Find) | State::Await { step: Step::Find, .. } => Phase::Finding,
            _ => Phase::SettingUp,
        }
    }

    /// Returns the settings.
    #[must_use]
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Returns the present rate of the port.
    #[must_use]
    pub fn baud(&self) -> Baud {
        self.at
    }

    /// Returns the scan line that the last `feed` reported.
    #[must_use]
    pub fn scan_line(&self) -> Option<ScanLine<'_>> {
        self.decoder.telegram()?.scan_line()
    }

    /// Returns what to do now.
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

    /// Takes received bytes up to the next event. Returns the number of bytes used and the event.
    /// Feed the rest again, even if it is empty, until [`SessionEvent::NeedMore`].
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

    /// Takes an event of the decoder.
    fn handle(&mut self, now_ms: u32, event: Event) -> Option<SessionEvent> {
        if let Event::Telegram { code: POWER_ON | RESET_ANSWER } = event {
            self.start_over(Trouble::Restarted);
            return None;
        }
        match (self.state, event) {
            (State::Listening, Event::Telegram { code: SCAN_LINE | SUB_RANGE | MEANS }) => {
                return Some(SessionEvent::ScanLine);
            }
            (State::Running { .. } | State::Listening, Event::Start { bytes_ago }) => {
                return Some(SessionEvent::Start { bytes_ago });
            }
            (State::Running { .. }, Event::Telegram { code: SCAN_LINE | SUB_RANGE | MEANS }) => {
                self.state = State::Running { deadline_ms: now_ms.wrapping_add(self.scan_timeout_ms()) };
                return Some(SessionEvent::ScanLine);
            }
            (State::Running { .. } | State::Listening, Event::Rejected(error)) => {
                // on a bad connection valid scan lines may be rare, but one with a valid head shows
                // that the scanner is running
                if let (State::Running { .. }, TelegramError::CheckWord { .. }) = (self.state, error) {
                    self.state = State::Running { deadline_ms: now_ms.wrapping_add(self.scan_timeout_ms()) };
                }
                return Some(SessionEvent::Rejected(error));
            }
            (State::Await { step, acknowledged: false, .. }, Event::Ack) => {
                let deadline_ms = now_ms.wrapping_add(step.answer_ms() + telegram_ms(self.at));
                self.state = State::Await { step, deadline_ms, acknowledged: true };
            }
            // at a wrong rate, or within a scan line, any byte can come: a NACK means nothing while
            // searching
            (State::Await { step, acknowledged: false, .. }, Event::Nack) if step != Step::Find => {
                self.failed(now_ms, step, Trouble::NotAcknowledged { command: self.command(step).code() });
            }
            // the answer was lost, but the scan lines come
            (State::Await { step: Step::Start, .. }, Event::Telegram { code: SCAN_LINE | SUB_RANGE | MEANS }) => {
                self.advance(now_ms, Step::Start);
                return Some(SessionEvent::ScanLine);
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
        step.command(&self.settings)
    }

    /// Sends the command of a step.
    fn send(&mut self, now_ms: u32, step: Step) -> Action {
        let bytes = self.command(step).encode();
        let count = bytes.as_slice().len() as u32;
        let gap_us = self.at.gap_us();
        let sending_ms = (self.at.line_time_us(count) + gap_us * count).div_ceil(1000);
        // a scan line may be under way and comes first
        let deadline_ms = now_ms.wrapping_add(sending_ms + ACKNOWLEDGE_MS + telegram_ms(self.at));
        self.state = State::Await { step, deadline_ms, acknowledged: false };
        self.decoder.expect_scan_lines((step == Step::Start).then(|| self.settings.format()));
        Action::Send { bytes, gap_us }
    }

    /// Goes to the step after this one, whose answer was good.
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

    /// Takes note of a failed try of this step: tries it again, or starts over.
    fn failed(&mut self, now_ms: u32, step: Step, trouble: Trouble) {
        self.tries += 1;
        if self.tries < step.tries() {
            self.pause(now_ms, PAUSE_MS, step);
        } else if step == Step::Find {
            self.next_rate();
        } else {
            self.start_over(trouble);
        }
    }

    /// Reports a trouble and starts over.
    fn start_over(&mut self, trouble: Trouble) {
        self.trouble = Some(trouble);
        if matches!(self.state, State::Listening) {
            return;
        }
        self.search_from(self.at);
        self.state = State::Tune { settle_ms: PAUSE_MS };
    }

    /// Begins the search with this rate.
    fn search_from(&mut self, rate: Baud) {
        self.tries = 0;
        self.at = rate;
        self.first = rate;
        self.searched = 0;
    }

    /// Goes to the next rate of the search: the first one, then all others, then again.
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

    /// Waits before a step.
    fn pause(&mut self, now_ms: u32, ms: u32, then: Step) {
        self.decoder.clear();
        self.state = State::Pause { until_ms: now_ms.wrapping_add(ms), then };
    }

    /// Looks for the answer among the bytes held, behind a false start byte, when the deadline has
    /// passed. Returns whether the session has advanced.
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

    /// Returns the time without a scan line after which the scanner counts as silent: that of three
    /// telegrams, and half a second in which it may be busy.
    fn scan_timeout_ms(&self) -> u32 {
        500 + 3 * (14 * u32::from(self.settings.variant.mirror_turns()) + telegram_ms(self.at))
    }
}

/// Returns the time of the longest telegram at this rate.
fn telegram_ms(rate: Baud) -> u32 {
    rate.line_time_us(MAX_TELEGRAM as u32).div_ceil(1000)
}

/// Returns the time to a deadline; `None` if it has passed.
fn time_left(now_ms: u32, until_ms: u32) -> Option<u32> {
    let left = until_ms.wrapping_sub(now_ms);
    (left != 0 && left <= LONGEST_MS).then_some(left)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A deadline passed long ago is not waited for, wherever the clock has wrapped to.
    #[test]
    fn away_for_weeks() {
        use super::super::format::{MeasuringMode, Unit, Variant};
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
        let longest_ms = Step::WriteConfiguration(configuration).answer_ms() + telegram_ms(Baud::B9600);
        assert!(longest_ms <= LONGEST_MS && Session::new(settings).scan_timeout_ms() <= LONGEST_MS);
    }

    #[test]
    fn size() {
        assert!(size_of::<TelegramDecoder>() < 900 && size_of::<Session>() < 1024);
    }
}
