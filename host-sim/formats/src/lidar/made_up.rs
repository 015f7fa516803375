//! Captures for tests.

use crate::lidar::velodyne::Model;

/// An IPv4 packet with a UDP datagram from 10.0.0.1 to a port.
pub fn udp_packet(port: u16, payload: &[u8]) -> Vec<u8> {
    let length = payload.len() as u16;
    let mut ip = vec![0x45, 0];
    ip.extend((28 + length).to_be_bytes());
    ip.extend([0, 0, 0, 0, 64, 17, 0, 0, 10, 0, 0, 1, 10, 0, 0, 2]);
    ip.extend(port.to_be_bytes());
    ip.extend(port.to_be_bytes());
    ip.extend((8 + length).to_be_bytes());
    ip.extend([0, 0]);
    ip.extend(payload);
    ip
}

/// An Ethernet frame of an IPv4 packet.
pub fn ethernet(ip: &[u8]) -> Vec<u8> {
    [&[0; 12][..], &[0x08, 0x00], ip].concat()
}

/// A pcap file of Ethernet frames.
pub fn pcap(frames: &[Vec<u8>]) -> Vec<u8> {
    let mut file = vec![0xD4, 0xC3, 0xB2, 0xA1, 2, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 1, 0, 0, 0];
    for frame in frames {
        let length = (frame.len() as u32).to_le_bytes();
        file.extend([0; 8].iter().chain(&length).chain(&length));
        file.extend(frame);
    }
    file
}

/// A pcapng file of Ethernet frames.
pub fn pcapng(frames: &[Vec<u8>]) -> Vec<u8> {
    let block = |kind: u32, body: &[u8]| {
        let length = (12 + body.len() as u32).to_le_bytes();
        [&kind.to_le_bytes(), &length, body, &length].concat()
    };
    let section = [&0x1A2B_3C4Du32.to_le_bytes()[..], &[1, 0, 0, 0], &[255; 8]].concat();
    let mut file = block(0x0A0D_0D0A, &section);
    file.extend(block(1, &[1, 0, 0, 0, 0, 0, 4, 0]));
    for frame in frames {
        let length = (frame.len() as u32).to_le_bytes();
        let padding = vec![0; frame.len().next_multiple_of(4) - frame.len()];
        file.extend(block(6, &[&[0; 12][..], &length, &length, frame, &padding].concat()));
    }
    file
}

/// A packet whose first firing is at `azimuth`, hundredths of a degree, and whose blocks are
/// `step` apart. The counts are 1000 + 100 * firing + laser.
pub fn velodyne_packet(model: Model, azimuth: u16, step: u16, dual: bool) -> Vec<u8> {
    let mut bytes = vec![];
    for block in 0..12u16 {
        let turned = if dual { block / 2 } else { block };
        bytes.extend([0xFF, 0xEE]);
        bytes.extend(((azimuth + turned * step) % 36000).to_le_bytes());
        for channel in 0..32u16 {
            let lasers = model.lasers() as u16;
            let firing = turned * (32 / lasers) + channel / lasers;
            let farther = if dual && block % 2 == 1 { 7 } else { 0 };
            bytes.extend((1000 + 100 * firing + channel % lasers + farther).to_le_bytes());
            bytes.push(50);
        }
    }
    bytes.extend([0, 0, 0, 0, if dual { 0x39 } else { 0x37 }]);
    bytes.push(match model {
        Model::Vlp16 => 0x22,
        Model::HiRes => 0x24,
        Model::Vlp32c => 0x28,
    });
    bytes
}
