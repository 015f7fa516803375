//! Captures of lidars and recordings of ROS 2: an error, or scans that fit their geometry; never more
//! memory than in proportion.
#![no_main]

use std::collections::BTreeMap;
use std::io::Cursor;

use libfuzzer_sys::fuzz_target;
use mcap::WriteOptions;
use mcap::records::MessageHeader;
use scanseg_formats::ReadOptions;
use scanseg_formats::lidar::{Assembler, FiringRows, Metadata, Turns, velodyne};
use scanseg_fuzz::scan_file;

const KINDS: [&str; 7] = [
    "sensor_msgs/msg/PointCloud2",
    "sensor_msgs/msg/Image",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/msg/LaserScan",
    "sensor_msgs/msg/JointState",
    "tf2_msgs/msg/TFMessage",
    "velodyne_msgs/msg/VelodyneScan",
];

fuzz_target!(|data: &[u8]| {
    let Some((&kind, data)) = data.split_first() else { return };
    match kind % 5 {
        // whatever it is
        0 => scan_file::read(data, &ReadOptions::default()),
        1 => scan_file::read(&capture(data), &ReadOptions::default()),
        2 => scan_file::read(&recording(data), &ReadOptions::default()),
        3 => {
            let end = data.iter().position(|byte| *byte == 0).unwrap_or(data.len());
            let Ok(metadata) = Metadata::parse(&String::from_utf8_lossy(&data[..end])) else { return };
            let mut assembler = Assembler::new(metadata);
            let packet: Vec<u8> =
                data[end..].iter().copied().cycle().take(assembler.metadata().packet_bytes()).collect();
            let done = assembler.push(&packet).into_iter().chain(assembler.finish());
            for frame in done {
                let (image, geometry) = assembler.metadata().image(&frame);
                geometry.check().expect("a geometry");
                geometry.fits(image.rows, image.columns).expect("its size");
            }
        }
        _ => {
            // a packet again and again, each time a little farther
            let Ok(model) = velodyne::Model::of(data.get(..velodyne::PACKET_BYTES).unwrap_or(data)) else { return };
            let mut packet = data[..velodyne::PACKET_BYTES].to_vec();
            let mut turns = Turns::new(model);
            let Ok(mut rows) = FiringRows::of(&packet, None) else { return };
            rows.geometry().check().expect("a geometry");
            let columns = rows.columns();
            for _ in 0..40 {
                rows.push(&packet, |row| {
                    assert!(row.range_m.len() == columns && (-360.0..=0.0).contains(&row.turn_deg));
                });
                if let Some(turn) = turns.push(&packet) {
                    let (image, geometry) = turn.image();
                    geometry.check().expect("a geometry");
                    geometry.fits(image.rows, image.columns).expect("its size");
                }
                packet[2] = packet[2].wrapping_add(data.get(velodyne::PACKET_BYTES).copied().unwrap_or(1));
            }
        }
    }
});

/// A pcap file of UDP datagrams: length, port, bytes.
fn capture(mut data: &[u8]) -> Vec<u8> {
    let mut file = vec![0xD4, 0xC3, 0xB2, 0xA1, 2, 0, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 4, 0, 101, 0, 0, 0];
    while let Some(([low, high, port], rest)) = data.split_first_chunk() {
        let length = usize::from(u16::from_le_bytes([*low, *high]) % 1300).min(rest.len());
        let (payload, rest) = rest.split_at(length);
        let mut ip = vec![0x45, 0];
        ip.extend((28 + length as u16).to_be_bytes());
        ip.extend([0, 0, 0, 0, 64, 17, 0, 0, 10, 0, 0, 1, 10, 0, 0, 2, 0, *port, 0, *port]);
        ip.extend((8 + length as u16).to_be_bytes());
        ip.extend([0, 0]);
        ip.extend(payload);
        let bytes = (ip.len() as u32).to_le_bytes();
        file.extend([0; 8].iter().chain(&bytes).chain(&bytes).chain(&ip));
        data = rest;
    }
    file
}

/// An MCAP file of messages: type, length, bytes.
fn recording(mut data: &[u8]) -> Vec<u8> {
    let mut bytes = Cursor::new(vec![]);
    let mut writer = WriteOptions::new().compression(None).create(&mut bytes).expect("a writer");
    while let Some(([kind, low, high], rest)) = data.split_first_chunk() {
        let length = usize::from(u16::from_le_bytes([*low, *high])).min(rest.len());
        let (message, rest) = rest.split_at(length);
        let kind = KINDS[usize::from(*kind) % KINDS.len()];
        let schema = writer.add_schema(kind, "ros2msg", b"").expect("a schema");
        let channel_id = writer.add_channel(schema, kind, "cdr", &BTreeMap::new()).expect("a channel");
        let header = MessageHeader { channel_id, sequence: 0, log_time: 0, publish_time: 0 };
        writer.write_to_known_channel(&header, message).expect("a message");
        data = rest;
    }
    writer.finish().expect("an end");
    drop(writer);
    bytes.into_inner()
}
