//! temporary bring-up
use std::io::{Read, Write};
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;

use embedded_hal::spi::{Operation, SpiDevice};
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_sim::format::{Geometry, GreyImage};
use scanseg_sim::virtual_rig::VirtualAs5048a;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

fn telegram(counts: &[u16]) -> Vec<u8> {
    let mut bytes = vec![0x02, 0x80];
    bytes.extend((4 + 2 * counts.len() as u16).to_le_bytes());
    bytes.push(0xB0);
    bytes.extend((0x4000 | counts.len() as u16).to_le_bytes());
    bytes.extend(counts.iter().flat_map(|count| count.to_le_bytes()));
    bytes.push(0x10);
    let check = check_word(&bytes);
    bytes.extend(check.to_le_bytes());
    bytes
}

fn main() -> Result<()> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [machine, elf] = &args[..] else { return Err("usage: firmware MACHINE ELF".into()) };
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/tilting-sick-corridor"));
    let image = GreyImage::read(data.join("scan000.range_mm.pgm"))?;
    let geometry = Geometry::read(data.join("geometry.toml"))?;
    println!("{} x {} {:?}", image.rows, image.columns, geometry.kind);
    let microbit = machine == "microbit";
    let mut stream = Vec::new();
    for row in image.values.chunks(image.columns) {
        let mut row = row.to_vec();
        row.resize(361, 32767);
        if microbit {
            row = row.into_iter().step_by(2).collect();
        }
        stream.extend(telegram(&row));
    }
    let dir = std::env::temp_dir().join(format!("scanseg-{}", std::process::id()));
    std::fs::create_dir_all(&dir)?;
    let names = if microbit { &["all"][..] } else { &["scanner", "encoder", "link"] };
    let ports: Vec<UnixListener> = names.iter().map(|n| UnixListener::bind(dir.join(n))).collect::<std::io::Result<_>>()?;
    let mut qemu: Child = Command::new(std::env::var("QEMU").unwrap_or("qemu-system-arm".into()))
        .args(["-machine", machine, "-icount", "shift=6", "-display", "none", "-monitor", "none", "-kernel", elf])
        .args(names.iter().flat_map(|n| ["-serial".into(), format!("unix:{}", dir.join(n).display())]))
        .stdin(Stdio::null())
        .spawn()?;
    let mut ports = ports.iter().map(|p| p.accept().map(|(s, _)| s)).collect::<std::io::Result<Vec<UnixStream>>>()?.into_iter();
    let mut row = 0.0;
    let mut sensor = VirtualAs5048a::new(move || {
        row += 1.0;
        (-48.7 + 0.516889 * (row - 1.0)) / 360.0
    });
    let mut answer = [0; 8];
    stream.extend([0; 256]);
    if microbit {
        let mut port = ports.next().unwrap();
        let mut link = Vec::new();
        let mut stream = &stream[..];
        while link.len() < 8 {
            let mut header = [0];
            port.read_exact(&mut header)?;
            let count = usize::from(header[0] & 63);
            match header[0] >> 6 {
                0 => {
                    let (piece, rest) = stream.split_at(count);
                    stream = rest;
                    port.write_all(&[&header, piece].concat())?;
                }
                1 => {
                    let mut words = [0; 2];
                    port.read_exact(&mut words)?;
                    let _ = sensor.transaction(&mut [Operation::TransferInPlace(&mut words)]);
                    port.write_all(&[&header[..], &words].concat())?;
                }
                _ => {
                    let mut piece = vec![0; count];
                    port.read_exact(&mut piece)?;
                    link.extend(piece);
                }
            }
        }
        answer.copy_from_slice(&link[..8]);
    } else {
        let (mut scanner, mut encoder, mut link) = (ports.next().unwrap(), ports.next().unwrap(), ports.next().unwrap());
        thread::spawn(move || {
            let mut words = [0; 2];
            while encoder.read_exact(&mut words).is_ok() {
                let _ = sensor.transaction(&mut [Operation::TransferInPlace(&mut words)]);
                let _ = encoder.write_all(&words);
            }
        });
        thread::spawn(move || scanner.write_all(&stream).map(|()| thread::sleep(std::time::Duration::from_secs(1000))));
        link.read_exact(&mut answer)?;
    }
    Command::new("kill").arg(qemu.id().to_string()).status()?;
    qemu.wait()?;
    std::fs::remove_dir_all(dir)?;
    let ticks = u32::from_le_bytes(answer[4..].try_into()?);
    println!("{:02x?} ticks {ticks}: {} per point", &answer[..4], f64::from(ticks) * if microbit { 62.5 / 64.0 / 226.0 / 181.0 } else { 40.0 / 64.0 / (226.0 * 361.0) });
    Ok(())
}
