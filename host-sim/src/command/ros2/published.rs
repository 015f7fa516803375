//! What is published.

use ros2_client::qos::{History, QosProfile, WhenFull};
use ros2_client::{MessageTypeName, Name, Node, Publisher};
use scanseg_core::Ranging;
use scanseg_formats::ros::LiveScan;
use scanseg_formats::{Axes, Scan};
use scanseg_sim::export::messages::{cloud, planes};
use scanseg_sim::export::{Header, MarkerArray, PointCloud2, Segmented};
use scanseg_sim::segmentation::within_limits;

use crate::command::output::Failure;

/// Reliable, so that any listener may have it: RViz asks for that, sensors' listeners do not. A
/// listener that is too slow does not hold it up.
const QOS: QosProfile =
    QosProfile::publisher_default().reliability_reliable(WhenFull::Fail).history(History::KeepLast { depth: 5 });

/// The topics that are published.
pub struct Published {
    points: Publisher<PointCloud2>,
    rows: Publisher<PointCloud2>,
    planes: Publisher<MarkerArray>,
}

impl Published {
    pub fn new(node: &mut Node) -> Result<Published, Failure> {
        let topic = |node: &Node, name, package, kind| -> Result<_, Failure> {
            Ok(node.create_topic(&Name::new("/scanseg", name)?, MessageTypeName::new(package, kind), &QOS)?)
        };
        let points = topic(node, "points", "sensor_msgs", "PointCloud2")?;
        let rows = topic(node, "rows", "sensor_msgs", "PointCloud2")?;
        let planes = topic(node, "planes", "visualization_msgs", "MarkerArray")?;
        let (points, rows) = (node.create_publisher(&points, None)?, node.create_publisher(&rows, None)?);
        Ok(Published { points, rows, planes: node.create_publisher(&planes, None)? })
    }

    /// Sends a row with the labels that its pixels have so far. Returns how many messages could not be
    /// sent.
    pub fn send_row(&self, row: &LiveScan, labels: &[u32], ranging: &Ranging) -> u64 {
        let Scan { image, geometry, .. } = &row.scan;
        let image = &within_limits(image, ranging);
        let row_of = Segmented { image, geometry, ranging, range_noise_m: &[], labels, segments: &[] };
        let header = Header::new(row.stamp_ns, &row.frame);
        u64::from(self.rows.publish(cloud(&row_of, 0..1, header, row.axes)).is_err())
    }

    /// Sends a scan. Returns how many of its messages could not be sent.
    pub fn send(&self, scan: &Segmented<'_>, stamp_ns: i64, frame: &str, axes: Axes) -> u64 {
        let header = Header::new(stamp_ns, frame);
        let planes = planes(scan, &header, axes);
        let points = cloud(scan, 0..scan.image.rows, header, axes);
        u64::from(self.points.publish(points).is_err()) + u64::from(self.planes.publish(planes).is_err())
    }
}
