//! STM32F407, 168 MHz from a crystal of 8 MHz (as on the Discovery board). Scanner on USART 1 (B6, B7),
//! by interrupt; encoder on SPI 2 (B12 select, B13 clock, B14 in, B15 out); link on USART 2 (A2), by DMA.
#![no_std]
#![no_main]

use embassy_executor::Spawner;
use embassy_stm32::gpio::{Level, Output, Speed};
use embassy_stm32::mode::Async;
use embassy_stm32::spi::{self, Spi};
use embassy_stm32::time::Hertz;
use embassy_stm32::usart::{self, BufferedUart, UartTx};
use embassy_stm32::{Config, bind_interrupts, dma, peripherals, rcc};
use embedded_hal_bus::spi::ExclusiveDevice;
use panic_halt as _;
use scanseg_embassy::board::{LINK, LINK_BAUD, QUEUE, ScannerPort, segment};
use static_cell::ConstStaticCell;

bind_interrupts!(struct Irqs {
    USART1 => usart::BufferedInterruptHandler<peripherals::USART1>;
    DMA1_STREAM6 => dma::InterruptHandler<peripherals::DMA1_CH6>;
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

fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(rcc::Hse { freq: Hertz(8_000_000), mode: rcc::HseMode::Oscillator });
    config.rcc.pll_src = rcc::PllSource::HSE;
    config.rcc.pll = Some(rcc::Pll {
        prediv: rcc::PllPreDiv::DIV4,
        mul: rcc::PllMul::MUL168,
        divp: Some(rcc::PllPDiv::DIV2),
        divq: None,
        divr: None,
    });
    config.rcc.sys = rcc::Sysclk::PLL1_P;
    config.rcc.apb1_pre = rcc::APBPrescaler::DIV4;
    config.rcc.apb2_pre = rcc::APBPrescaler::DIV2;
    config
}

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = embassy_stm32::init(clocks());

    let mut config = usart::Config::default();
    config.baudrate = LINK_BAUD;
    let uart = UartTx::new(board.USART2, board.PA2, board.DMA1_CH6, Irqs, config).unwrap();
    spawner.spawn(link(uart).unwrap());

    let mut config = spi::Config::default();
    config.mode = spi::MODE_1;
    config.frequency = Hertz(5_000_000);
    let spi = Spi::new_blocking(board.SPI2, board.PB13, board.PB15, board.PB14, config);
    let select = Output::new(board.PB12, Level::High, Speed::High);
    let encoder = ExclusiveDevice::new_no_delay(spi, select).unwrap();

    let (sent, received) = (SENT.take(), RECEIVED.take());
    let config = usart::Config::default();
    let uart = BufferedUart::new(board.USART1, board.PB7, board.PB6, sent, received, Irqs, config).unwrap();
    // 84 MHz make all rates of the scanner
    let set_baud =
        |uart: &mut BufferedUart<'static>, baud_per_s| uart.set_baudrate(baud_per_s).map_err(|_| usart::Error::Framing);
    segment(ScannerPort { uart, set_baud }, encoder).await;
}
