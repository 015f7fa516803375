//! Image for the micro:bit (Cortex-M0).
#![no_std]
#![no_main]

use m0_float as _;
use scanseg_core::{Beams, Columns, Config, EdgeSegmenter, TurnAxis, buffers};
use scanseg_firmware::mux::{Channel, Line};
use scanseg_firmware::{chain, meter::Nrf51Timer, uart::nrf51::Uart, wire::SpiOver};
use scanseg_hal::lms2xx::{Decoder, Variant};

const CONFIG: Config = Config { min_range_m: 0.48, ..Config::paper() };
const COLUMNS: usize = 181;

#[cortex_m_rt::entry]
fn main() -> ! {
    static mut BUFFERS: buffers!(COLUMNS, CONFIG) = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    static mut DECODER: Decoder = Decoder::new();
    static mut ROW: [f32; COLUMNS] = [0.0; COLUMNS];
    // SAFETY: the UART and the timer are there, and each is taken once.
    let (uart, timer) = unsafe { (Uart::new(), Nrf51Timer::new()) };
    let line = |line| Channel::new(uart, line);
    let columns = Columns::Even { start_rad: -core::f32::consts::FRAC_PI_2, step_rad: 1_f32.to_radians() };
    let beams = Beams::Nodding { columns, axis: TurnAxis::Y };
    let Ok(segmenter) = EdgeSegmenter::new(CONFIG, beams, COLUMNS, BUFFERS.memory()) else { loop {} };
    chain::run(
        line(Line::Scanner),
        SpiOver(line(Line::Encoder)),
        line(Line::Link),
        segmenter,
        DECODER,
        ROW,
        Variant::Deg180Step1,
        226,
        timer,
    )
}
