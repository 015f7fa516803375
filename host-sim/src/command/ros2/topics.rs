//! The topics that are subscribed to.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use ros2_client::dds::rustdds::mio1::{Events, Interest, Poll, Token};
use ros2_client::dds::rustdds::no_key::SimpleDataReader;
use ros2_client::dds::rustdds::{QosPolicies, Subscriber};
use ros2_client::qos::{Durability, History, QosProfile, WhenFull};
use ros2_client::{Context, Gid, MessageInfo, MessageTypeName, Name, Node};
use scanseg_formats::ros::Needed;

use crate::command::live::incoming::{Incoming, unbroken};
use crate::command::output::Failure;
use crate::command::ros2::cdr::AsItIs;

/// As sensors have it: what is lost is not sent again.
const SENSOR: QosProfile = QosProfile::subscription_default().history(History::KeepLast { depth: 5 });
/// As /tf_static has it.
const LATCHED: QosProfile = QosProfile::publisher_default()
    .reliability_reliable(WhenFull::DEFAULT)
    .durability(Durability::TransientLocal)
    .history(History::KeepLast { depth: 100 });
/// So many scans may wait.
const SCANS: usize = 5;
/// So many rows and transforms may wait.
const ROWS: usize = 1024;

/// Subscriptions, each with its place in what is needed.
pub struct Topics {
    readers: Vec<SimpleDataReader<Vec<u8>, AsItIs>>,
    counted: Counted,
}

/// The messages of the first topic by their numbers.
#[derive(Default)]
struct Counted {
    last: HashMap<Gid, i64>,
    lost: Arc<AtomicU64>,
}

impl Topics {
    pub fn subscribe(context: &Context, node: &Node, needed: &[Needed]) -> Result<Topics, Failure> {
        let subscriber: Subscriber = context.domain_participant().create_subscriber(&QosPolicies::qos_none())?;
        let reader = |needed: &Needed| -> Result<_, Failure> {
            let qos = if needed.latched { LATCHED } else { SENSOR };
            let kind = MessageTypeName::new(needed.package, needed.kind);
            let topic = node.create_topic(&Name::parse(&needed.topic)?, kind, &qos)?;
            Ok(subscriber.create_simple_datareader_no_key::<Vec<u8>, AsItIs>(&topic, Some(qos.into()))?)
        };
        Ok(Topics { readers: needed.iter().map(reader).collect::<Result<_, _>>()?, counted: Counted::default() })
    }

    /// Counts the messages of the first topic that did not come, by the gaps between their numbers.
    pub fn lost(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.counted.lost)
    }

    /// Returns what comes: the place of its topic, and its CDR.
    pub fn incoming(self) -> Result<Incoming<(usize, Vec<u8>)>, Failure> {
        let Topics { mut readers, mut counted } = self;
        let waiting = if readers.len() > 2 { ROWS } else { SCANS };
        let mut poll = Poll::new()?;
        for (i, reader) in readers.iter_mut().enumerate() {
            poll.registry().register(reader, Token(i), Interest::READABLE)?;
        }
        let mut events = Events::with_capacity(readers.len());
        // what is there has no event
        let mut next = readers.len();
        Ok(Incoming::new(waiting, false, move || {
            loop {
                while let Some(i) = next.checked_sub(1) {
                    readers[i].drain_read_notifications();
                    // one that cannot be read is like one that did not come
                    if let Ok(Some(message)) = readers[i].try_take_one() {
                        if i == 0 {
                            let info = MessageInfo::from(&message);
                            counted.count(info.publisher_gid(), info.sequence_number());
                        }
                        return Some((i, message.into_value()));
                    }
                    next = i;
                }
                unbroken(|| poll.poll(&mut events, None))?;
                next = readers.len();
            }
        }))
    }
}

impl Counted {
    /// Notes a message, by its number.
    fn count(&mut self, publisher: Gid, number: i64) {
        if let Some(last) = self.last.insert(publisher, number) {
            self.lost.fetch_add(u64::try_from(number - last - 1).unwrap_or(0), Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_between_the_numbers_of_each_publisher_are_lost_messages() {
        let mut counted = Counted::default();
        let lost = Arc::clone(&counted.lost);
        let [a, b] = [[1; 16], [2; 16]].map(Gid::from);
        // what came before the first one is not lost; one that comes late counts as lost all the same
        for (publisher, number) in [(a, 7), (b, 1), (a, 8), (a, 11), (b, 2), (a, 10), (b, 4)] {
            counted.count(publisher, number);
        }
        assert_eq!(lost.load(Ordering::Relaxed), 3);
    }
}
