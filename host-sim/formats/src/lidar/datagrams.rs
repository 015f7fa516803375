//! The UDP datagrams of a packet capture: pcap and pcapng files.

use std::io::Read;
use std::net::IpAddr;

use pcap_parser::pcapng::Block;
use pcap_parser::traits::PcapReaderIterator;
use pcap_parser::{Linktype, PcapBlockOwned, PcapError, create_reader};

use crate::lidar::ip::{Fragments, Udp, udp};
use crate::scan_error::ScanError;

/// Room for one packet with all that a capture says of it. No capture program writes longer ones.
const BUFFER_BYTES: usize = 1 << 19;

/// The most interfaces of a capture that are told apart.
const MAX_INTERFACES: usize = 1024;

/// Where a datagram came from and went to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flow {
    /// The address of the sender.
    pub source: IpAddr,
    /// The port of the receiver.
    pub port: u16,
}

/// One UDP datagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Datagram<'a> {
    /// Where it came from and went to.
    pub flow: Flow,
    /// What it carries.
    pub payload: &'a [u8],
}

/// The UDP datagrams of a capture in their order. What is no whole UDP datagram is passed over;
/// fragments are joined. Memory: 512 KiB for the file, 512 KiB for fragments.
pub struct Datagrams {
    reader: Box<dyn PcapReaderIterator + Send>,
    /// What the packets of each interface begin with.
    links: Vec<Linktype>,
    fragments: Fragments,
    payload: Vec<u8>,
}

impl Datagrams {
    /// Whether these are the first bytes of a capture, of which there must be 4.
    pub fn is_capture(first: &[u8]) -> bool {
        let magic = |bytes: &[u8; 4]| {
            let swapped = [bytes[3], bytes[2], bytes[1], bytes[0]];
            [*bytes, swapped].iter().any(|bytes| {
                matches!(u32::from_be_bytes(*bytes), 0xA1B2_C3D4 | 0xA1B2_3C4D | 0xA1B2_CD34 | 0x0A0D_0D0A)
            })
        };
        first.first_chunk().is_some_and(magic)
    }

    /// Reads the beginning of a capture.
    ///
    /// # Errors
    /// [`ScanError::Damaged`].
    pub fn new(file: impl Read + Send + 'static) -> Result<Datagrams, ScanError> {
        let reader = create_reader(BUFFER_BYTES, file).map_err(|e| damaged(said(&e)))?;
        Ok(Datagrams { reader, links: vec![], fragments: Fragments::default(), payload: vec![] })
    }

    /// Returns the next datagram, `None` at the end. A capture that breaks off within a packet ends
    /// before it.
    ///
    /// # Errors
    /// [`ScanError::Damaged`].
    pub fn next_datagram(&mut self) -> Result<Option<Datagram<'_>>, ScanError> {
        loop {
            let (length, flow) = match self.reader.next() {
                Ok((length, block)) => {
                    (length, datagram(&block, &mut self.links, &mut self.fragments, &mut self.payload))
                }
                Err(PcapError::Eof | PcapError::UnexpectedEof) => return Ok(None),
                Err(PcapError::Incomplete(_)) => {
                    let (before, exhausted) = (self.reader.data().len(), self.reader.reader_exhausted());
                    self.reader.refill().map_err(|e| damaged(said(&e)))?;
                    if self.reader.data().len() > before {
                        continue;
                    }
                    if exhausted || self.reader.reader_exhausted() {
                        return Ok(None);
                    }
                    return Err(damaged("a packet that is too long"));
                }
                Err(e) => return Err(damaged(said(&e))),
            };
            self.reader.consume(length);
            if let Some(flow) = flow {
                return Ok(Some(Datagram { flow, payload: &self.payload }));
            }
        }
    }

    /// Returns what the last datagram carries.
    pub(crate) fn payload(&self) -> &[u8] {
        &self.payload
    }
}

/// Puts the datagram of a block into `payload`, if it holds one or the last fragment of one.
fn datagram(
    block: &PcapBlockOwned<'_>,
    links: &mut Vec<Linktype>,
    fragments: &mut Fragments,
    payload: &mut Vec<u8>,
) -> Option<Flow> {
    let (interface, data) = match block {
        PcapBlockOwned::LegacyHeader(header) => {
            *links = vec![header.network];
            return None;
        }
        PcapBlockOwned::NG(Block::SectionHeader(_)) => {
            links.clear();
            return None;
        }
        PcapBlockOwned::NG(Block::InterfaceDescription(interface)) => {
            if links.len() < MAX_INTERFACES {
                links.push(interface.linktype);
            }
            return None;
        }
        PcapBlockOwned::Legacy(packet) => (0, packet.data),
        PcapBlockOwned::NG(Block::EnhancedPacket(packet)) => {
            (packet.if_id as usize, packet.data.get(..packet.caplen as usize)?)
        }
        PcapBlockOwned::NG(Block::SimplePacket(packet)) => (0, packet.data),
        PcapBlockOwned::NG(_) => return None,
    };
    let ip = network_layer(*links.get(interface)?, data)?;
    let Udp { source, port, payload: carried } = udp(ip, fragments)?;
    payload.clear();
    payload.extend_from_slice(&carried);
    Some(Flow { source, port })
}

/// Returns the IP packet of a frame.
fn network_layer(link: Linktype, frame: &[u8]) -> Option<&[u8]> {
    let big = |at: usize| Some(u16::from_be_bytes(frame.get(at..)?.first_chunk().copied()?));
    let (mut ether_type, mut start) = match link {
        Linktype::ETHERNET => (big(12)?, 14),
        Linktype::LINUX_SLL => (big(14)?, 16),
        Linktype::LINUX_SLL2 => (big(0)?, 20),
        // the family of addresses, in the order of bytes of the machine; IP tells itself
        Linktype::NULL | Linktype::LOOP => return frame.get(4..),
        Linktype::RAW | Linktype::IPV4 | Linktype::IPV6 => return Some(frame),
        _ => return None,
    };
    // tags of virtual networks
    while matches!(ether_type, 0x8100 | 0x88A8) {
        (ether_type, start) = (big(start + 2)?, start + 4);
    }
    matches!(ether_type, 0x0800 | 0x86DD).then(|| frame.get(start..))?
}

fn damaged(how: &str) -> ScanError {
    ScanError::damaged("packet capture", how)
}

fn said(e: &PcapError<&[u8]>) -> &'static str {
    match e {
        PcapError::HeaderNotRecognized => "neither pcap nor pcapng",
        PcapError::BufferTooSmall => "a packet that is too long",
        PcapError::ReadError => "it cannot be read",
        PcapError::Eof | PcapError::UnexpectedEof | PcapError::Incomplete(_) => "it ends in its header",
        PcapError::NomError(..) | PcapError::OwnedNomError(..) => "a packet or header makes no sense",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::made_up::{ethernet, pcap, pcapng, udp_packet};

    fn all(bytes: Vec<u8>) -> Result<Vec<(u16, Vec<u8>)>, ScanError> {
        let mut datagrams = Datagrams::new(std::io::Cursor::new(bytes))?;
        let mut found = vec![];
        while let Some(datagram) = datagrams.next_datagram()? {
            found.push((datagram.flow.port, datagram.payload.to_vec()));
        }
        Ok(found)
    }

    #[test]
    fn datagrams_of_both_kinds_of_file() {
        let frames = [ethernet(&udp_packet(7502, &[1, 2, 3])), vec![9; 5], ethernet(&udp_packet(2368, &[4]))];
        let expected = vec![(7502, vec![1, 2, 3]), (2368, vec![4])];
        for file in [pcap(&frames), pcapng(&frames)] {
            assert!(Datagrams::is_capture(&file));
            assert_eq!(all(file), Ok(expected.clone()));
        }
        assert!(!Datagrams::is_capture(b"P5\n1"));
    }

    #[test]
    fn a_capture_that_breaks_off_ends_before_the_packet() {
        let frames = [ethernet(&udp_packet(1, &[1])), ethernet(&udp_packet(2, &[2]))];
        for file in [pcap(&frames), pcapng(&frames)] {
            assert_eq!(all(file[..file.len() - 2].to_vec()), Ok(vec![(1, vec![1])]));
        }
    }

    #[test]
    fn a_false_length_is_no_reason_to_take_memory_or_time() {
        let mut file = pcap(&[ethernet(&udp_packet(1, &[1]))]);
        file[24 + 8..24 + 12].copy_from_slice(&0x7FFF_FFFFu32.to_le_bytes());
        assert!(matches!(all(file), Err(ScanError::Damaged { .. }) | Ok(_)));
        let mut file = pcapng(&[ethernet(&udp_packet(1, &[1]))]);
        let at = 28 + 20 + 4;
        file[at..at + 4].copy_from_slice(&0x7FFF_FFF0u32.to_le_bytes());
        file.resize(2 * BUFFER_BYTES, 0);
        assert!(matches!(all(file), Err(ScanError::Damaged { .. }) | Ok(_)));
    }

    #[test]
    fn tags_and_other_links() {
        let ip = udp_packet(5, &[7]);
        let tagged = [&[0; 12][..], &[0x81, 0, 0, 9, 0x08, 0], &ip].concat();
        assert_eq!(network_layer(Linktype::ETHERNET, &tagged), Some(&ip[..]));
        let cooked = [&[0; 14][..], &[0x08, 0], &ip].concat();
        assert_eq!(network_layer(Linktype::LINUX_SLL, &cooked), Some(&ip[..]));
        let arp = [&[0; 12][..], &[0x08, 6], &ip].concat();
        assert_eq!(network_layer(Linktype::ETHERNET, &arp), None);
        assert_eq!(network_layer(Linktype::ETHERNET, &arp[..9]), None);
    }
}
