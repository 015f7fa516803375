//! What is published.

use ros2_client::qos::{History, QosProfile, WhenFull};
use ros2_client::{MessageTypeName, Name, Node, Publisher};
use scanseg_formats::Axes;
use scanseg_sim::export::messages::{cloud, planes};
use scanseg_sim::export::{Header, MarkerArray, PointCloud2, Segmented};

use crate::command::output::Failure;

/// Reliable, so that any listener may have it: RViz asks for that, sensors' listeners do not. A
/// listener that is too slow does not hold it up.
const QOS: QosProfile =
    QosProfile::publisher_default().reliability_reliable(WhenFull::Fail).history(History::KeepLast { depth: 5 });

/// The topics that are published.
pub struct Published {
    points: Publisher<PointCloud2>,
    planes: Publisher<MarkerArray>,
}

impl Published {
    pub fn new(node: &mut Node) -> Result<Published, Failure> {
        let topic = |node: &Node, name, package, kind| -> Result<_, Failure> {
            Ok(node.create_topic(&Name::new("/scanseg", name)?, MessageTypeName::new(package, kind), &QOS)?)
        };
        let points = topic(node, "points", "sensor_msgs", "PointCloud2")?;
        let planes = topic(node, "planes", "visualization_msgs", "MarkerArray")?;
        Ok(Published { points: node.create_publisher(&points, None)?, planes: node.create_publisher(&planes, None)? })
    }

    /// Sends a scan. Returns how many of its messages could not be sent.
    pub fn send(&self, scan: &Segmented<'_>, stamp_ns: i64, frame: &str, axes: Axes) -> u64 {
        let header = Header::new(stamp_ns, frame);
        let planes = planes(scan, &header, axes);
        let points = cloud(scan, 0..scan.image.rows, header, axes);
        u64::from(self.points.publish(points).is_err()) + u64::from(self.planes.publish(planes).is_err())
    }
}
