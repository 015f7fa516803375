//! The blocking and the async scanner on a simulated port.

use core::cell::RefCell;
use core::future::{Future, poll_fn};
use core::pin::pin;
use core::task::{Context, Poll, Waker};
use std::collections::VecDeque;
use std::rc::Rc;

use scanseg_hal::lms2xx::{
    Baud, Error, MeasuringMode, Phase, Scanner, ScannerEvent, Settings, Trouble, Unit, Variant, asynch, blocking,
};
use scanseg_virtual_rig::{Beam, VirtualLms};

const SETTINGS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step05,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: true,
};

/// Scanner, port and clock. Looking at the clock or the port takes 2 us.
struct World {
    lms: VirtualLms,
    now_us: u64,
    baud: Baud,
    received: VecDeque<u8>,
    /// Written, but not yet flushed: the port keeps it to itself.
    outgoing: Vec<u8>,
    ended: bool,
    /// So many calls of the port from now, one fails; 0: none does.
    fail_in: u32,
    /// An async port was not ready when it was asked last.
    put_off: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Broken;

impl core::fmt::Display for Broken {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "broken")
    }
}

impl core::error::Error for Broken {}

impl embedded_io::Error for Broken {
    fn kind(&self) -> embedded_io::ErrorKind {
        embedded_io::ErrorKind::Other
    }
}

#[derive(Clone)]
struct Wire(Rc<RefCell<World>>);

impl Wire {
    fn new() -> Self {
        let lms =
            VirtualLms::new(|beam: Beam| 2000 + beam.bearing_deg as u16).running(Baud::B9600, Variant::Deg100Step1);
        let world = World {
            lms,
            now_us: 0,
            baud: Baud::B38400,
            received: VecDeque::new(),
            outgoing: vec![],
            ended: false,
            fail_in: 0,
            put_off: false,
        };
        Self(Rc::new(RefCell::new(world)))
    }

    fn clock(&self) -> impl FnMut() -> u64 + use<> {
        let wire = self.clone();
        move || wire.pass(2)
    }

    fn pass(&self, us: u64) -> u64 {
        let world = &mut *self.0.borrow_mut();
        world.now_us += us;
        let bytes = world.lms.read(world.now_us, world.baud);
        world.received.extend(bytes);
        world.now_us
    }

    fn ready(&self) -> bool {
        self.pass(2);
        let world = self.0.borrow();
        !world.received.is_empty() || world.ended
    }

    fn take(&self, buffer: &mut [u8]) -> usize {
        let received = &mut self.0.borrow_mut().received;
        let count = buffer.len().min(received.len());
        for (to, byte) in buffer.iter_mut().zip(received.drain(..count)) {
            *to = byte;
        }
        count
    }

    /// Takes some of the bytes.
    fn put(&self, bytes: &[u8]) -> usize {
        let world = &mut *self.0.borrow_mut();
        let count = if world.ended { 0 } else { bytes.len().min(3) };
        world.outgoing.extend(&bytes[..count]);
        count
    }

    fn flush_out(&self) {
        let world = &mut *self.0.borrow_mut();
        let bytes = core::mem::take(&mut world.outgoing);
        world.now_us = world.lms.write(world.now_us, &bytes, world.baud);
    }

    fn fails(&self) -> Result<(), Broken> {
        let fail_in = &mut self.0.borrow_mut().fail_in;
        let now = *fail_in == 1;
        *fail_in = fail_in.saturating_sub(1);
        if now { Err(Broken) } else { Ok(()) }
    }

    /// Every other time an async port is not ready.
    async fn put_off(&self) {
        poll_fn(|_| {
            let put_off = &mut self.0.borrow_mut().put_off;
            *put_off = !*put_off;
            if *put_off { Poll::Pending } else { Poll::Ready(()) }
        })
        .await;
    }

    /// Stop, rate, stop, variant, read, install, write, leave, start; none of them twice.
    fn commands_were_each_sent_once(&self) {
        assert_eq!(self.0.borrow().lms.commands, [0x20, 0x20, 0x20, 0x3B, 0x74, 0x20, 0x77, 0x20, 0x20]);
    }

    fn set_baud(&self, baud: Baud) {
        self.pass(1);
        let world = &mut *self.0.borrow_mut();
        assert!(world.outgoing.is_empty(), "every byte has left the port before its rate is changed");
        world.baud = baud;
        world.received.clear();
    }
}

impl embedded_io::ErrorType for Wire {
    type Error = Broken;
}

impl embedded_io::Read for Wire {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Broken> {
        assert!(self.ready(), "a blocking read that nothing would end");
        self.fails()?;
        Ok(self.take(buffer))
    }
}

impl embedded_io::ReadReady for Wire {
    fn read_ready(&mut self) -> Result<bool, Broken> {
        self.fails()?;
        Ok(self.ready())
    }
}

impl embedded_io::Write for Wire {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Broken> {
        self.fails()?;
        Ok(self.put(bytes))
    }

    fn flush(&mut self) -> Result<(), Broken> {
        self.fails()?;
        self.flush_out();
        Ok(())
    }
}

impl blocking::Port for Wire {
    fn set_baud(&mut self, baud: Baud) -> Result<(), Broken> {
        Wire::set_baud(self, baud);
        Ok(())
    }
}

impl embedded_hal::delay::DelayNs for Wire {
    fn delay_ns(&mut self, ns: u32) {
        self.pass(u64::from(ns).div_ceil(1000));
    }
}

impl embedded_io_async::Read for Wire {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Broken> {
        poll_fn(|_| if self.ready() { Poll::Ready(()) } else { Poll::Pending }).await;
        self.fails()?;
        Ok(self.take(buffer))
    }
}

impl embedded_io_async::Write for Wire {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Broken> {
        self.put_off().await;
        self.fails()?;
        Ok(self.put(bytes))
    }

    async fn flush(&mut self) -> Result<(), Broken> {
        self.put_off().await;
        self.fails()?;
        self.flush_out();
        Ok(())
    }
}

impl asynch::Port for Wire {
    fn set_baud(&mut self, baud: Baud) -> Result<(), Broken> {
        Wire::set_baud(self, baud);
        Ok(())
    }
}

impl embedded_hal_async::delay::DelayNs for Wire {
    async fn delay_ns(&mut self, ns: u32) {
        let until_us = self.pass(0) + u64::from(ns).div_ceil(1000);
        poll_fn(|_| if self.pass(2) >= until_us { Poll::Ready(()) } else { Poll::Pending }).await;
    }
}

/// Runs to the end, or gives up after so many polls.
fn run<T>(future: impl Future<Output = T>, polls: u32) -> Option<T> {
    let mut future = pin!(future);
    let mut context = Context::from_waker(Waker::noop());
    for _ in 0..polls {
        if let Poll::Ready(result) = future.as_mut().poll(&mut context) {
            return Some(result);
        }
    }
    None
}

/// What happened, boiled down; both shells must show the same.
#[derive(Default)]
struct Log {
    scans: u32,
    /// Starts since the last scan, and when the last was.
    starts: u32,
    start_us: u64,
    troubles: Vec<Trouble>,
}

impl Log {
    fn add(&mut self, event: ScannerEvent, scan: Option<scanseg_hal::lms2xx::ScanLine<'_>>) {
        match event {
            ScannerEvent::Start { time_us } => {
                self.starts += 1;
                // The start byte ends 20 us after the end of a mirror turn; the port is asked now
                // and then.
                let after_turn = time_us % 40_000 % 13_333;
                assert!((15..60).contains(&after_turn), "start at {time_us}, {after_turn} us after the turn");
                assert!(self.start_us == 0 || time_us - self.start_us < 13_400);
                self.start_us = time_us;
            }
            ScannerEvent::ScanLine => {
                assert_eq!(core::mem::take(&mut self.starts), 1, "each scan has its start");
                let scan = scan.expect("scan");
                let quarter = scan.partial_quarter().expect("interlaced");
                assert_eq!(scan.columns(), if quarter == 0 { 181 } else { 180 });
                assert!(scan.words().eq((0..scan.columns()).map(|column| 2000 + column)));
                self.scans += 1;
            }
            ScannerEvent::Rejected(error) => panic!("{error}"),
            ScannerEvent::Trouble(trouble) => self.troubles.push(trouble),
        }
    }
}

#[test]
fn blocking_scanner() {
    let wire = Wire::new();
    let mut scanner = Scanner::new(wire.clone(), wire.clock(), wire.clone(), SETTINGS);
    let mut log = Log::default();
    while log.scans < 100 {
        let event = scanner.next_event().expect("port");
        log.add(event, scanner.scan_line());
    }
    assert_eq!((log.troubles.len(), scanner.phase()), (0, Phase::Running));

    // Taken apart and put together again it finds the scanner where it was left.
    let (port, clock, delay) = scanner.release();
    let mut scanner = Scanner::new(port, clock, delay, SETTINGS);
    let mut log = Log::default();
    while log.scans < 100 {
        let event = scanner.next_event().expect("port");
        log.add(event, scanner.scan_line());
        // Meanwhile the next scan begins and some twenty bytes come: the time of its start must not
        // suffer.
        if event == ScannerEvent::ScanLine {
            wire.pass(6300);
        }
    }
    assert_eq!(wire.0.borrow().lms.eeprom_writes, 1);

    wire.0.borrow_mut().ended = true;
    loop {
        match scanner.next_event() {
            Ok(_) => {}
            Err(error) => {
                assert_eq!(error, Error::Ended);
                break;
            }
        }
    }
}

#[test]
fn nobody_on_the_port() {
    let wire = Wire::new();
    wire.0.borrow_mut().lms.wires.faults.drop_one_in = 1;
    let mut scanner = Scanner::new(wire.clone(), wire.clock(), wire.clone(), SETTINGS);
    assert_eq!(scanner.next_event(), Ok(ScannerEvent::Trouble(Trouble::NotFound)));
    let blocking_us = wire.pass(0);
    assert!(blocking_us < 10_000_000, "the call must return within seconds");
    let event = run(scanner.next_event_async(), u32::MAX).expect("event");
    assert_eq!(event, Ok(ScannerEvent::Trouble(Trouble::NotFound)));
    assert!(wire.pass(0) - blocking_us < 10_000_000);
}

#[test]
fn async_scanner() {
    let wire = Wire::new();
    let mut scanner = Scanner::new(wire.clone(), wire.clock(), wire.clone(), SETTINGS);
    let mut log = Log::default();
    while log.scans < 100 {
        let event = run(scanner.next_event_async(), u32::MAX).expect("event").expect("port");
        log.add(event, scanner.scan_line());
    }
    assert_eq!(log.troubles, []);
    wire.commands_were_each_sent_once();
    let (port, clock, delay) = scanner.release();
    let mut scanner = Scanner::new(port, clock, delay, SETTINGS);
    run(scanner.next_event_async(), u32::MAX).expect("event").expect("port");
    wire.0.borrow_mut().ended = true;
    let end = loop {
        if let Err(error) = run(scanner.next_event_async(), u32::MAX).expect("event") {
            break error;
        }
    };
    assert_eq!(end, Error::Ended);
}

/// The future is dropped over and over, wherever it waits: for bytes, for the port to take some,
/// for them to leave it, and between them. Nothing is lost either way, and nothing is sent twice.
#[test]
fn async_scanner_cancelled() {
    let wire = Wire::new();
    let mut scanner = Scanner::new(wire.clone(), wire.clock(), wire.clone(), SETTINGS);
    let mut log = Log::default();
    let mut cancelled = 0u32;
    while log.scans < 100 {
        match run(scanner.next_event_async(), 1 + cancelled % 97) {
            Some(event) => log.add(event.expect("port"), scanner.scan_line()),
            None => cancelled += 1,
        }
    }
    assert!(cancelled > 1000);
    assert_eq!(log.troubles, []);
    wire.commands_were_each_sent_once();
}

/// Every so often a call of the port fails, whichever it is: the error comes out, and the next call
/// goes on.
#[test]
fn errors_of_the_port() {
    for blocking in [true, false] {
        for every in [7, 20, 61, 1000] {
            let wire = Wire::new();
            let mut scanner = Scanner::new(wire.clone(), wire.clock(), wire.clone(), SETTINGS);
            let (mut log, mut errors) = (Log::default(), 0);
            while log.scans < 10 {
                if wire.0.borrow().fail_in == 0 {
                    wire.0.borrow_mut().fail_in = every;
                }
                let event = match blocking {
                    true => scanner.next_event(),
                    false => run(scanner.next_event_async(), u32::MAX).expect("event"),
                };
                match event {
                    Ok(event) => log.add(event, scanner.scan_line()),
                    Err(error) => {
                        assert_eq!(error, Error::Port(Broken));
                        errors += 1;
                    }
                }
            }
            assert!(errors > 3, "{errors}");
            assert_eq!(log.troubles, []);
            wire.commands_were_each_sent_once();
        }
    }
}

/// A port that takes no bytes any more has ended, too.
#[test]
fn port_that_takes_nothing() {
    let wire = Wire::new();
    wire.0.borrow_mut().ended = true;
    wire.0.borrow_mut().received.extend([0; 5]);
    let mut scanner = Scanner::new(wire.clone(), wire.clock(), wire.clone(), SETTINGS);
    let mut calls = 0;
    while scanner.next_event() != Err(Error::Ended) {
        calls += 1;
        assert!(calls < 5);
    }
    assert_eq!(Error::Port(Broken).to_string(), "scanner port: broken");
    assert_eq!(Error::<Broken>::Ended.to_string(), "scanner port has ended");
}

/// The start byte of the next scan lies in the inbox behind the end of the last one, and the caller
/// takes its time: the byte is not taken to be the later for it.
#[test]
fn caller_that_takes_its_time() {
    let wire = Wire::new();
    let mut scanner = Scanner::new(wire.clone(), wire.clock(), wire.clone(), SETTINGS);
    let mut log = Log::default();
    while log.scans < 50 {
        let event = scanner.next_event().expect("port");
        log.add(event, scanner.scan_line());
        match event {
            // Until the port holds all of this scan and the first bytes of the next.
            ScannerEvent::Start { time_us } => _ = wire.pass((time_us + 13_400).saturating_sub(wire.pass(0))),
            ScannerEvent::ScanLine => _ = wire.pass(3_000),
            _ => {}
        }
    }
}
