//! A machine of QEMU that runs an image, and a scanner, an encoder and a host on its serial ports.

use std::fs;
use std::io::{self, ErrorKind, Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;

use scanseg_firmware::figures::{COUNT, MAGIC};
use scanseg_firmware::mux::Line;

use crate::host::Frames;

/// Longest time without a byte before an image is taken to have stopped.
const PATIENCE: Duration = Duration::from_secs(60);

/// How often the file of the link is looked at, and its name.
const POLL: Duration = Duration::from_millis(50);
const LINK_FILE: &str = "link";

/// How the three lines reach the machine.
#[derive(Clone, Copy, PartialEq)]
pub enum Wiring {
    /// A UART each: scanner, encoder, link.
    Apart,
    /// What scanner and encoder say is in the image; the link goes to a file.
    LinkToFile,
    /// All over one, see [`scanseg_firmware::mux`].
    Shared,
}

/// Runs an image: sends `stream` as the scanner and answers with `frames` as the encoder. Gives the
/// first `wanted` bytes of the link, or those that came before the image fell silent or asked the
/// encoder for something else.
pub fn run(
    machine: &str,
    wiring: Wiring,
    image: &Path,
    stream: &[u8],
    frames: Frames,
    wanted: usize,
) -> io::Result<Vec<u8>> {
    let (_qemu, mut ports) = start(machine, wiring, image)?;
    let mut link = Vec::new();
    let ended = match &mut ports[..] {
        [scanner, encoder, output] => {
            let (scanner, encoder) = (scanner.try_clone()?, encoder.try_clone()?);
            let stream = stream.to_vec();
            // both end when the machine does
            thread::spawn(move || (&scanner).write_all(&stream));
            thread::spawn(move || answer(&encoder, frames));
            output.take(wanted as u64).read_to_end(&mut link).map(|_| ())
        }
        [port] => shared(port, stream, frames, wanted, &mut link),
        _ => Ok(()),
    };
    match ended {
        Err(error) if error.kind() != ErrorKind::WouldBlock => Err(error),
        _ => Ok(link),
    }
}

/// Runs an image that has scanner and encoder in it: sends the time of a byte, in ticks of the
/// timer. Gives all that came of the link up to a record of figures, or until it fell silent.
pub fn run_paced(machine: &str, image: &Path, byte_ticks: u32) -> io::Result<Vec<u8>> {
    const RECORD: usize = 4 * (1 + COUNT);
    // a file takes every byte at once, so that nothing depends on this program
    let (qemu, mut ports) = start(machine, Wiring::LinkToFile, image)?;
    let [host] = &mut ports[..] else { return Ok(vec![]) };
    host.write_all(&byte_ticks.to_le_bytes())?;
    let mut patience = PATIENCE;
    let mut before = 0;
    loop {
        thread::sleep(POLL);
        let link = fs::read(qemu.sockets.join(LINK_FILE)).unwrap_or_default();
        let over = link.len() >= RECORD && link[link.len() - RECORD..].starts_with(&MAGIC.to_le_bytes());
        if over || patience.is_zero() {
            return Ok(link);
        }
        patience = if link.len() == before { patience.saturating_sub(POLL) } else { PATIENCE };
        before = link.len();
    }
}

/// Ends the machine when it is dropped.
struct Qemu {
    process: Child,
    sockets: PathBuf,
}

impl Drop for Qemu {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
        let _ = fs::remove_dir_all(&self.sockets);
    }
}

fn start(machine: &str, wiring: Wiring, image: &Path) -> io::Result<(Qemu, Vec<UnixStream>)> {
    let sockets = std::env::temp_dir().join(format!("scanseg-firmware-{}", std::process::id()));
    fs::create_dir_all(&sockets)?;
    let lines = if wiring == Wiring::Apart { 3 } else { 1 };
    let file = format!("file:{}", sockets.join(LINK_FILE).display());
    let link = if wiring == Wiring::LinkToFile { &["-serial", "null", "-serial", &file][..] } else { &[] };
    let paths: Vec<PathBuf> = (0..lines).map(|line| sockets.join(line.to_string())).collect();
    let listeners = paths.iter().map(UnixListener::bind).collect::<io::Result<Vec<_>>>()?;
    let process = Command::new("qemu-system-arm")
        // one instruction takes 2^6 ns
        .args(["-machine", machine, "-icount", "shift=6", "-display", "none", "-monitor", "none"])
        .arg("-kernel")
        .arg(image)
        .args(paths.iter().flat_map(|path| ["-serial".into(), format!("unix:{}", path.display())]))
        .args(link)
        .stdin(Stdio::null())
        .spawn()?;
    let mut qemu = Qemu { process, sockets };
    let mut ports = Vec::new();
    for listener in listeners {
        ports.push(accept(&listener, &mut qemu)?);
    }
    Ok((qemu, ports))
}

fn accept(listener: &UnixListener, qemu: &mut Qemu) -> io::Result<UnixStream> {
    listener.set_nonblocking(true)?;
    loop {
        match listener.accept() {
            Err(error) if error.kind() == ErrorKind::WouldBlock => {
                if let Some(status) = qemu.process.try_wait()? {
                    return Err(io::Error::other(format!("QEMU ended with {status}")));
                }
                thread::sleep(Duration::from_millis(10));
            }
            port => {
                let (port, _) = port?;
                port.set_nonblocking(false)?;
                port.set_read_timeout(Some(PATIENCE))?;
                return Ok(port);
            }
        }
    }
}

/// The encoder: gives each frame's answer, as long as the frames are those expected.
fn answer(mut port: &UnixStream, frames: Frames) -> io::Result<()> {
    for (expected, answer) in frames {
        let mut frame = [0; 2];
        port.read_exact(&mut frame)?;
        if frame != expected {
            break;
        }
        port.write_all(&answer)?;
    }
    Ok(())
}

/// Scanner, encoder and host on one port.
fn shared(
    port: &mut UnixStream,
    mut stream: &[u8],
    mut frames: Frames,
    wanted: usize,
    link: &mut Vec<u8>,
) -> io::Result<()> {
    while link.len() < wanted {
        let mut header = [0];
        port.read_exact(&mut header)?;
        let [byte] = header;
        let (line, count) = (byte >> 6, usize::from(byte & 63));
        let mut bytes = vec![0; count];
        if line == Line::Scanner as u8 {
            // no more to send: the image waits, and so do we
            let Some((piece, rest)) = stream.split_at_checked(count) else { continue };
            stream = rest;
            port.write_all(&[&header, piece].concat())?;
        } else if line == Line::Encoder as u8 {
            port.read_exact(&mut bytes)?;
            match frames.pop_front() {
                Some((expected, answer)) if bytes == expected => port.write_all(&[&header[..], &answer].concat())?,
                _ => return Ok(()),
            }
        } else {
            port.read_exact(&mut bytes)?;
            link.extend(bytes);
        }
    }
    Ok(())
}
