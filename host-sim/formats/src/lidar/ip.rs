//! IP and UDP headers of captured packets, and the joining of fragments: a packet of an Ouster with
//! 128 rings is longer than a frame of Ethernet.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::net::IpAddr;

const UDP: u8 = 17;
/// Fragmented datagrams that are joined at the same time. An older one is given up.
const MAX_JOINED: usize = 8;

/// A UDP datagram.
pub struct Udp<'a> {
    pub source: IpAddr,
    pub port: u16,
    pub payload: Cow<'a, [u8]>,
}

/// Which datagram a fragment belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Key {
    source: IpAddr,
    destination: IpAddr,
    identification: u32,
}

/// A part of a datagram.
struct Part<'a> {
    key: Key,
    offset: usize,
    more: bool,
    bytes: &'a [u8],
}

/// A datagram of which parts have come.
struct Joined {
    key: Key,
    bytes: Vec<u8>,
    /// Where bytes are, ordered and apart.
    filled: Vec<(usize, usize)>,
    /// Its length, once the last part has come.
    length: Option<usize>,
}

/// Datagrams of which parts have come.
#[derive(Default)]
pub struct Fragments(VecDeque<Joined>);

/// Returns the UDP datagram of an IP packet, or the one that it completes.
pub fn udp<'a>(ip: &'a [u8], fragments: &mut Fragments) -> Option<Udp<'a>> {
    let part = match ip.first()? >> 4 {
        4 => version_4(ip)?,
        6 => version_6(ip)?,
        _ => return None,
    };
    let source = part.key.source;
    let datagram: Cow<'a, [u8]> =
        if part.offset == 0 && !part.more { Cow::Borrowed(part.bytes) } else { Cow::Owned(fragments.join(&part)?) };
    let field = |at: usize| Some(u16::from_be_bytes(datagram.get(at..)?.first_chunk().copied()?));
    let (port, length) = (field(2)?, usize::from(field(4)?));
    // Jumbo datagrams say 0, and are none of a lidar.
    if length < 8 || length > datagram.len() {
        return None;
    }
    let payload = match datagram {
        Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[8..length]),
        Cow::Owned(mut bytes) => {
            bytes.truncate(length);
            bytes.drain(..8);
            Cow::Owned(bytes)
        }
    };
    Some(Udp { source, port, payload })
}

fn version_4(ip: &[u8]) -> Option<Part<'_>> {
    let fixed: &[u8; 20] = ip.first_chunk()?;
    let big = |at: usize| u16::from_be_bytes([fixed[at], fixed[at + 1]]);
    let (header, length, flags) = (4 * usize::from(fixed[0] & 15), usize::from(big(2)), big(6));
    if fixed[9] != UDP || header < 20 {
        return None;
    }
    let address = |at: usize| IpAddr::from([fixed[at], fixed[at + 1], fixed[at + 2], fixed[at + 3]]);
    let key = Key { source: address(12), destination: address(16), identification: big(4).into() };
    let (offset, more) = (8 * usize::from(flags & 0x1FFF), flags & 0x2000 != 0);
    Some(Part { key, offset, more, bytes: ip.get(header..length)? })
}

fn version_6(ip: &[u8]) -> Option<Part<'_>> {
    let fixed: &[u8; 40] = ip.first_chunk()?;
    let address = |at: usize| fixed[at..].first_chunk::<16>().copied().map(IpAddr::from);
    let mut key = Key { source: address(8)?, destination: address(24)?, identification: 0 };
    let length = usize::from(u16::from_be_bytes([fixed[4], fixed[5]]));
    let (mut next, mut bytes) = (fixed[6], ip.get(40..40 + length)?);
    let (mut offset, mut more) = (0, false);
    while next != UDP {
        let head: &[u8; 8] = bytes.first_chunk()?;
        let skipped = match next {
            // options of hops and of the destination, routing
            0 | 43 | 60 => 8 + 8 * usize::from(head[1]),
            44 => {
                let field = u16::from_be_bytes([head[2], head[3]]);
                (offset, more) = (usize::from(field & 0xFFF8), field & 1 != 0);
                key.identification = u32::from_be_bytes([head[4], head[5], head[6], head[7]]);
                8
            }
            _ => return None,
        };
        (next, bytes) = (head[0], bytes.get(skipped..)?);
    }
    Some(Part { key, offset, more, bytes })
}

impl Fragments {
    /// Adds a part. Returns the datagram if it is complete now.
    fn join(&mut self, part: &Part<'_>) -> Option<Vec<u8>> {
        let end = part.offset + part.bytes.len();
        if end > usize::from(u16::MAX) || part.bytes.is_empty() {
            return None;
        }
        let at = self.0.iter().position(|joined| joined.key == part.key).unwrap_or_else(|| {
            if self.0.len() == MAX_JOINED {
                self.0.pop_front();
            }
            self.0.push_back(Joined { key: part.key, bytes: vec![], filled: vec![], length: None });
            self.0.len() - 1
        });
        let joined = &mut self.0[at];
        if joined.bytes.len() < end {
            joined.bytes.resize(end, 0);
        }
        joined.bytes[part.offset..end].copy_from_slice(part.bytes);
        joined.fill(part.offset, end);
        if !part.more {
            joined.length = Some(end);
        }
        let complete = joined.length.is_some_and(|length| joined.filled == [(0, length)]);
        complete.then(|| self.0.remove(at).map(|joined| joined.bytes))?
    }
}

impl Joined {
    /// Notes that bytes are there, and joins what touches.
    fn fill(&mut self, mut start: usize, mut end: usize) {
        self.filled.retain(|&(from, to)| {
            let apart = to < start || from > end;
            if !apart {
                (start, end) = (start.min(from), end.max(to));
            }
            apart
        });
        let at = self.filled.partition_point(|&(from, _)| from < start);
        self.filled.insert(at, (start, end));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::made_up::udp_packet;

    /// The packet of a part of a datagram.
    fn fragment(whole: &[u8], from: usize, to: usize, identification: u16) -> Vec<u8> {
        let mut ip = whole[..20].to_vec();
        let more = if 20 + to < whole.len() { 0x2000 } else { 0 };
        ip[2..4].copy_from_slice(&((20 + to - from) as u16).to_be_bytes());
        ip[4..6].copy_from_slice(&identification.to_be_bytes());
        ip[6..8].copy_from_slice(&(more | (from / 8) as u16).to_be_bytes());
        ip.extend_from_slice(&whole[20 + from..20 + to]);
        ip
    }

    #[test]
    fn fragments_are_joined_in_any_order_and_twice() {
        let sent: Vec<u8> = (0..100).collect();
        let whole = udp_packet(7502, &sent);
        let parts = [(0, 40), (40, 80), (80, 108)];
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            let mut fragments = Fragments::default();
            let mut came = vec![];
            for (i, part) in order.into_iter().enumerate() {
                for _ in 0..if i < 2 { 2 } else { 1 } {
                    let (from, to) = parts[part];
                    let packet = fragment(&whole, from, to, 5);
                    came.extend(udp(&packet, &mut fragments).map(|udp| (udp.port, udp.payload.into_owned())));
                }
            }
            assert_eq!(came, [(7502, sent.clone())]);
            assert!(fragments.0.is_empty());
        }
    }

    #[test]
    fn what_is_never_completed_is_given_up() {
        let whole = udp_packet(1, &[0; 100]);
        let mut fragments = Fragments::default();
        for identification in 0..100 {
            assert!(udp(&fragment(&whole, 0, 40, identification), &mut fragments).is_none());
        }
        assert_eq!(fragments.0.len(), MAX_JOINED);
        // beyond the longest datagram
        let mut far = fragment(&whole, 0, 40, 7);
        far[6..8].copy_from_slice(&0x1FFFu16.to_be_bytes());
        assert!(udp(&far, &mut fragments).is_none());
        assert!(fragments.0.iter().all(|joined| joined.bytes.len() == 40));
    }

    #[test]
    fn version_6_with_a_fragment_header() {
        let datagram = [&[0, 1, 0, 2, 0, 24, 0, 0][..], &[5; 16]].concat();
        let packet = |head: [u8; 8], bytes: &[u8]| {
            let length = (8 + bytes.len()) as u16;
            [&[0x60, 0, 0, 0][..], &length.to_be_bytes(), &[44, 64], &[1; 32], &head, bytes].concat()
        };
        let mut fragments = Fragments::default();
        let first = packet([17, 0, 0, 1, 0, 0, 0, 9], &datagram[..16]);
        assert!(udp(&first, &mut fragments).is_none());
        let last = packet([17, 0, 0, 16, 0, 0, 0, 9], &datagram[16..]);
        let joined = udp(&last, &mut fragments).unwrap();
        assert_eq!((joined.port, &*joined.payload), (2, &[5; 16][..]));
    }

    #[test]
    fn other_protocols_and_broken_lengths_are_passed_over() {
        let mut fragments = Fragments::default();
        let whole = udp_packet(1, &[1, 2, 3, 4]);
        for length in 0..whole.len() {
            assert!(udp(&whole[..length], &mut fragments).is_none(), "{length}");
        }
        let mut tcp = whole.clone();
        tcp[9] = 6;
        assert!(udp(&tcp, &mut fragments).is_none());
        let mut long = whole;
        long[24] = 1;
        assert!(udp(&long, &mut fragments).is_none());
    }
}
