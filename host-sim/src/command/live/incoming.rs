//! Packets and bytes as they come, each with its time; a thread takes them off the wire.

use std::fs::File;
use std::io::{self, Read};
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, TrySendError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use crate::command::output::Failure;

/// So many packets of a scanner may wait: half a second of an Ouster with 128 rings, 8 MiB.
const WAITING: usize = 1024;

/// What came at once.
pub struct Packet<T = Vec<u8>> {
    pub content: T,
    pub came: Instant,
}

/// What there is next.
pub enum Next<T> {
    Packet(Packet<T>),
    /// Nothing has come in the time.
    Nothing,
    /// Nothing will come.
    End,
}

/// What comes.
pub struct Incoming<T = Vec<u8>> {
    packets: Receiver<Packet<T>>,
    dropped: Arc<AtomicU64>,
}

impl Incoming {
    /// Datagrams to a port of this machine. Returns the address as well: port 0 is any that is free.
    pub fn udp(address: &str) -> Result<(Incoming, SocketAddr), Failure> {
        let whole = if address.contains(':') { address.to_string() } else { format!("0.0.0.0:{address}") };
        let failed = |e: io::Error| format!("udp:{address}: {e}");
        let socket = UdpSocket::bind(&whole).map_err(failed)?;
        let bound = socket.local_addr().map_err(failed)?;
        let mut buffer = vec![0; usize::from(u16::MAX)];
        // nobody waits for a packet that has not been taken
        let incoming = Incoming::new(WAITING, false, move || {
            let length = unbroken(|| socket.recv(&mut buffer))?;
            Some(buffer[..length].to_vec())
        });
        Ok((incoming, bound))
    }

    /// The bytes of a file or device.
    pub fn bytes(path: &str) -> Result<Incoming, Failure> {
        let mut source: Box<dyn Read + Send> = match path {
            "-" => Box::new(io::stdin()),
            path => Box::new(File::open(path).map_err(|e| format!("{path}: {e}"))?),
        };
        let mut buffer = vec![0; 4096];
        Ok(Incoming::new(WAITING, true, move || {
            let length = unbroken(|| source.read(&mut buffer)).filter(|length| *length > 0)?;
            Some(buffer[..length].to_vec())
        }))
    }
}

/// Returns what a call to the system returns, none if it fails. One that a signal broke off, as when the
/// program stood still and goes on, is made again.
pub fn unbroken<T>(mut call: impl FnMut() -> io::Result<T>) -> Option<T> {
    loop {
        match call() {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            result => return result.ok(),
        }
    }
}

impl<T: Send + 'static> Incoming<T> {
    /// Takes what `read` returns, up to its end. `waiting` of it may wait. `waits`: whether the source
    /// waits while nobody takes what came.
    pub fn new(waiting: usize, waits: bool, read: impl FnMut() -> Option<T> + Send + 'static) -> Incoming<T> {
        let (sender, packets) = sync_channel(waiting);
        let dropped = Arc::new(AtomicU64::new(0));
        let counter = Arc::clone(&dropped);
        thread::spawn(move || forward(waits, read, &sender, &counter));
        Incoming { packets, dropped }
    }

    /// Returns what comes next within a time.
    pub fn next(&self, within: Duration) -> Next<T> {
        match self.packets.recv_timeout(within) {
            Ok(packet) => Next::Packet(packet),
            Err(RecvTimeoutError::Timeout) => Next::Nothing,
            Err(RecvTimeoutError::Disconnected) => Next::End,
        }
    }

    /// Returns how many packets had no room to wait.
    pub fn dropped(&self) -> u64 {
        self.dropped.load(Ordering::Relaxed)
    }
}

fn forward<T>(waits: bool, mut read: impl FnMut() -> Option<T>, sender: &SyncSender<Packet<T>>, dropped: &AtomicU64) {
    while let Some(content) = read() {
        let packet = Packet { content, came: Instant::now() };
        let gone = if waits {
            sender.send(packet).is_err()
        } else {
            match sender.try_send(packet) {
                Ok(()) => false,
                Err(TrySendError::Full(_)) => {
                    dropped.fetch_add(1, Ordering::Relaxed);
                    false
                }
                Err(TrySendError::Disconnected(_)) => true,
            }
        };
        if gone {
            return;
        }
    }
}
