//! Serial ports of the machines: registers, polled, as embedded-io readers and writers.

pub mod cmsdk;
pub mod nrf51;
