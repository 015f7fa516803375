//! What errors say: each names what is wrong, with its numbers.

use scanseg_hal::encoder::{Calibration, Direction, as5048a, as5600};
use scanseg_hal::lms2xx::{Error, ScanLineError, TelegramError, Trouble};
use scanseg_hal::rig::RigError;

#[test]
fn texts() {
    let gear = Calibration::new(0, Direction::Same, -2.0).expect_err("no gear");
    let errors: [(&dyn core::error::Error, &str); 29] = [
        (&Trouble::NotFound, "no scanner answers at any baud rate"),
        (&Trouble::NoAnswer { command: 0x3B }, "command 0x3b is not answered"),
        (&Trouble::NotAcknowledged { command: 0x20 }, "command 0x20 arrives damaged"),
        (&Trouble::Refused { command: 0x77, reason: 0x92 }, "command 0x77 is refused with 0x92"),
        (&Trouble::Configuration { length: 3 }, "configuration block has 3 bytes"),
        (&Trouble::Silent, "scans have stopped"),
        (&Trouble::Restarted, "scanner has restarted"),
        (&TelegramError::CheckWord { computed: 1, found: 0xABCD }, "check word is 0xabcd, should be 0x0001"),
        (&TelegramError::Status(0x17), "status byte 0x17 has no such severity"),
        (&TelegramError::Unfinished { got: 9 }, "telegram broke off after 9 bytes"),
        (&TelegramError::ScanLine(ScanLineError::TooShort { length: 3 }), "scan telegram: 3 bytes are too few"),
        (&ScanLineError::Length { length: 364, count: 181 }, "364 bytes do not hold 181 values"),
        (&ScanLineError::Count(180), "180 values are not expected"),
        (&ScanLineError::Unit(3), "unit code 3 is not expected"),
        (&ScanLineError::Partial { partial: true, quarter: 2 }, "partial = true at quarter 2 is not expected"),
        (&ScanLineError::SubRange { first: 9, last: 1 }, "sub-range 9 to 1 does not fit the count"),
        (&gear, "gear ratio must be from 0.001 to 1000000, is -2"),
        (&as5048a::FrameError::Parity(0x8001), "answer 0x8001 has odd parity"),
        (&as5048a::FrameError::Flagged, "error flag is set"),
        (&as5048a::Error::<()>::Parity(0x8001), "AS5048A answer 0x8001 has odd parity"),
        (&as5048a::Error::<()>::Sensor(as5048a::Faults(4)), "AS5048A flagged an error, faults 0x4"),
        (&as5048a::Error::Bus("gone"), "AS5048A bus: \"gone\""),
        (&as5600::Error::<()>::NoMagnet(as5600::MagnetStatus(0x10)), "AS5600 detects no magnet, status 0x10"),
        (&Error::<core::fmt::Error>::Ended, "scanner port has ended"),
        (&RigError::Rates { min: 2.0, max: 1.0 }, "the tilt cannot turn at 2 to 1 rad/s"),
        (&RigError::Sweep(-1.0), "a sweep cannot be -1 rad"),
        (&RigError::Pause { needed_us: 40_000, got_us: 7 }, "pause must be 40000 us or more, is 7"),
        (&RigError::Memory { needed: 362, got: 361 }, "rows need memory for 362 numbers, got 361"),
        (&RigError::Mount { field: "step_rad", value: 0.0 }, "step_rad of a mount cannot be 0"),
    ];
    for (error, text) in errors {
        assert_eq!(error.to_string(), text);
    }
}
