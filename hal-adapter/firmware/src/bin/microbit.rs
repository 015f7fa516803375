//! Image for the micro:bit (Cortex-M0, 16 KiB of RAM): 181 columns. Scanner, encoder and link share the UART, see
//! [`scanseg_firmware::mux`].
#![no_std]
#![no_main]

use m0_float as _;
#[cfg(not(feature = "region"))]
use scanseg_core::EdgeSegmenter as Segmenter;
#[cfg(feature = "region")]
use scanseg_core::RegionSegmenter as Segmenter;
use scanseg_core::buffers;
use scanseg_firmware::figures::{self, Timed};
use scanseg_firmware::mux::{Channel, Line};
use scanseg_firmware::run::{CONFIG, MICROBIT, MICROBIT_AREAS, Ports, limits, run};
use scanseg_firmware::uart::nrf51::Uart;
use scanseg_firmware::wire::SpiOver;
use scanseg_hal::lms2xx::Session;
use scanseg_hal::rig::{Rig, beams};

const COLUMNS: usize = MICROBIT.variant.columns() as usize;

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut BUFFERS: buffers!(COLUMNS, CONFIG, MICROBIT_AREAS) = <buffers!(COLUMNS, CONFIG, MICROBIT_AREAS)>::EMPTY;
    static mut ROWS_M: [f32; 2 * COLUMNS] = [0.0; 2 * COLUMNS];
    static mut SESSION: Session = Session::listening(MICROBIT);
    figures::begin();
    // SAFETY: this is an nRF51, and its UART is taken once.
    let uart = unsafe { Uart::new() };
    let [scanner, encoder, link] = [Line::Scanner, Line::Encoder, Line::Link].map(|line| Channel::new(uart, line));
    let segmenter = Segmenter::new(CONFIG, beams(MICROBIT.variant), COLUMNS, BUFFERS.memory());
    if let Ok(segmenter) = segmenter
        && let Ok(mut rig) = Rig::new(MICROBIT, limits(&MICROBIT), Timed(segmenter), ROWS_M)
    {
        let ports = Ports { scanner, encoder: SpiOver(encoder), link };
        run(ports, &MICROBIT, SESSION, &mut rig, || figures::send(link));
    }
    loop {
        core::hint::spin_loop();
    }
}

/// The vectors of interrupts: there are none.
// SAFETY: the section and the name are those that cortex-m-rt's linker script expects; no interrupt is ever enabled.
#[unsafe(link_section = ".vector_table.interrupts")]
#[unsafe(no_mangle)]
static __INTERRUPTS: [usize; 1] = [0];
