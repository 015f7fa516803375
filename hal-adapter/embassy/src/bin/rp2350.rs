//! RP2350, 150 MHz (as on a Pico 2). Scanner on UART 0 (pins 0, 1), by interrupt; encoder on SPI 0 (pins
//! 16 in, 17 select, 18 clock, 19 out); link on UART 1 (pin 4), by DMA.
#![no_std]
#![no_main]

use embassy_executor::Spawner;
use embassy_rp::gpio::{Level, Output};
use embassy_rp::spi::{self, Spi};
use embassy_rp::uart::{self, Async, BufferedInterruptHandler, BufferedUart, UartTx};
use embassy_rp::{bind_interrupts, dma, peripherals};
use embedded_hal_bus::spi::ExclusiveDevice;
use panic_halt as _;
use scanseg_embassy::board::{LINK, LINK_BAUD, QUEUE, ScannerPort, segment};
use static_cell::ConstStaticCell;

bind_interrupts!(struct Irqs {
    UART0_IRQ => BufferedInterruptHandler<peripherals::UART0>;
    DMA_IRQ_0 => dma::InterruptHandler<peripherals::DMA_CH0>;
});

/// Bytes from the scanner, and to it.
static RECEIVED: ConstStaticCell<[u8; QUEUE]> = ConstStaticCell::new([0; QUEUE]);
static SENT: ConstStaticCell<[u8; 64]> = ConstStaticCell::new([0; 64]);

#[embassy_executor::task]
async fn link(mut uart: UartTx<'static, Async>) {
    let mut piece = [0; 256];
    loop {
        let count = LINK.read(&mut piece).await;
        let _ = uart.write(&piece[..count]).await;
    }
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = embassy_rp::init(embassy_rp::config::Config::default());

    let mut config = uart::Config::default();
    config.baudrate = LINK_BAUD;
    let uart = UartTx::new(board.UART1, board.PIN_4, board.DMA_CH0, Irqs, config);
    spawner.spawn(link(uart).unwrap());

    let mut config = spi::Config::default();
    config.phase = spi::Phase::CaptureOnSecondTransition;
    config.frequency = 5_000_000;
    let spi = Spi::new_blocking(board.SPI0, board.PIN_18, board.PIN_19, board.PIN_16, config);
    let select = Output::new(board.PIN_17, Level::High);
    let encoder = ExclusiveDevice::new_no_delay(spi, select).unwrap();

    let (sent, received) = (SENT.take(), RECEIVED.take());
    let config = uart::Config::default();
    let uart = BufferedUart::new(board.UART0, board.PIN_0, board.PIN_1, Irqs, sent, received, config);
    let set_baud = |uart: &mut BufferedUart, baud_per_s| {
        uart.set_baudrate(baud_per_s);
        Ok(())
    };
    segment(ScannerPort { uart, set_baud }, encoder).await;
}
