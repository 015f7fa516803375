"""Recordings and captures that other programs write are read.

    python strangers_captures.py SCANSEG FOLDER
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

scanseg, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
rng = np.random.default_rng(14)


def run(*arguments):
    return subprocess.run([scanseg, *map(str, arguments)], capture_output=True, text=True)


def segment(path, *arguments):
    out = folder / (Path(path).name + ".captures")
    result = run("segment", path, "--out", out, *arguments)
    assert result.returncode == 0, f"{path}: {result.stderr}"
    return json.loads((out / "segments.json").read_text())["segments"]


def walls(segments, distances_m, path):
    """The large segments lie at these distances."""
    large = sorted(s["distance_m"] for s in segments if s["pixels"] > 300)
    assert len(large) == len(distances_m) and np.allclose(large, distances_m, atol=0.01), f"{path}: {large}"
    print(f"read: {path}, {len(large)} walls")


# A corner: a wall 3 m ahead, one 2 m to the left; noise of 3 mm.
def corner(directions):
    with np.errstate(divide="ignore"):
        ahead = np.where(directions[..., 0] > 0, 3.0 / directions[..., 0], np.inf)
        left = np.where(directions[..., 1] > 0, 2.0 / directions[..., 1], np.inf)
    return np.minimum(ahead, left) + rng.normal(0, 0.003, directions.shape[:-1])


v, u = np.mgrid[:60, :80]
optical = np.stack([(u - 60) / 60.0, (v - 29.5) / 60.0, np.ones(u.shape)], axis=-1)
directions = np.stack([optical[..., 2], -optical[..., 0], -optical[..., 1]], axis=-1)
directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
ranges = corner(directions)
points = (directions * ranges[..., None]).astype("<f4")
depth_mm = np.round(1000 * ranges * directions[..., 0]).astype("<u2")
stamp = {"sec": 1, "nanosec": 0}


def laser_rows():
    """A scanner that tilts from 30 deg up to 30 deg down in 4 s, and its transforms: time, angle, ranges."""
    beams = np.radians(np.arange(-40, 41))
    for i in range(401):
        turn = np.radians(30 - 0.15 * i)
        ranges = None
        if i % 4 == 0 and i < 400:
            # each beam at its own time
            turns = turn - np.radians(15) * 0.0001 * np.arange(len(beams))
            parts = [np.cos(beams) * np.cos(turns), np.sin(beams), np.cos(beams) * np.sin(turns)]
            ranges = corner(np.stack(parts, axis=-1)).astype(np.float32)
        yield i * 0.01, turn, beams, ranges


# ---- rosbags: SQLite

import rosbags.rosbag2
from rosbags.typesys import Stores, get_typestore

store = get_typestore(Stores.ROS2_HUMBLE)
T = store.types
time = T["builtin_interfaces/msg/Time"]


def header(frame, seconds=1.0):
    return T["std_msgs/msg/Header"](stamp=time(sec=int(seconds), nanosec=round(seconds % 1 * 1e9)), frame_id=frame)


def write(path, messages):
    """Messages: topic, type, time, message."""
    try:
        writer = rosbags.rosbag2.Writer(path)
    except TypeError:  # later versions
        writer = rosbags.rosbag2.Writer(path, version=8)
    with writer:
        connections = {}
        for topic, kind, seconds, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            data = store.serialize_cdr(message, kind)
            writer.write(connections[topic], round(seconds * 1e9), data)


def field(name, offset):
    return T["sensor_msgs/msg/PointField"](name=name, offset=offset, datatype=7, count=1)


cloud = T["sensor_msgs/msg/PointCloud2"](
    header=header("map"), height=60, width=80, fields=[field(n, 4 * i) for i, n in enumerate("xyz")],
    is_bigendian=False, point_step=12, row_step=960, data=np.frombuffer(points.tobytes(), np.uint8), is_dense=True)
# as drivers of spinning lidars have it: a list, each point with its ring, what has no return left out
elevation, azimuth = np.radians(np.linspace(15, -15, 16)), np.radians(180 - 0.5 * np.arange(720))
lidar = np.stack([np.cos(elevation)[:, None] * np.cos(azimuth), np.cos(elevation)[:, None] * np.sin(azimuth),
                  np.sin(elevation)[:, None] + 0 * azimuth], axis=-1)
around = lidar * (2 / np.abs(lidar[..., :2]).max(axis=-1))[..., None]
seen = np.random.default_rng(5).random(around.shape[:2]) < 0.7
ringed = np.zeros(seen.sum(), np.dtype([("xyz", "<f4", 3), ("intensity", "<f4"), ("ring", "<u2")]))
ringed["xyz"], ringed["ring"] = around[seen], np.broadcast_to(np.arange(16)[::-1, None], seen.shape)[seen]
ringed = ringed[np.random.default_rng(6).permutation(len(ringed))]
ring_fields = [field(n, 4 * i) for i, n in enumerate(("x", "y", "z", "intensity"))]
ring_fields.append(T["sensor_msgs/msg/PointField"](name="ring", offset=16, datatype=4, count=1))
rings = T["sensor_msgs/msg/PointCloud2"](
    header=header("velodyne"), height=1, width=len(ringed), fields=ring_fields, is_bigendian=False, point_step=18,
    row_step=18 * len(ringed), data=np.frombuffer(ringed.tobytes(), np.uint8), is_dense=True)
image = T["sensor_msgs/msg/Image"](
    header=header("camera"), height=60, width=80, encoding="16UC1", is_bigendian=0, step=160,
    data=np.frombuffer(depth_mm.tobytes(), np.uint8))
roi = T["sensor_msgs/msg/RegionOfInterest"](x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
info = T["sensor_msgs/msg/CameraInfo"](
    header=header("camera"), height=60, width=80, distortion_model="plumb_bob", d=np.zeros(5),
    k=np.array([60, 0, 60, 0, 60, 29.5, 0, 0, 1.0]), r=np.eye(3).ravel(), p=np.zeros(12), binning_x=0, binning_y=0, roi=roi)

write(folder / "clouds", [("/points", "sensor_msgs/msg/PointCloud2", 1, cloud)])
walls(segment(folder / "clouds"), [2.0, 3.0], "clouds (rosbags, SQLite, a folder)")
write(folder / "rings", [("/points", "sensor_msgs/msg/PointCloud2", 1, rings)])
found = segment(folder / "rings")
large = [s for s in found if s["pixels"] > 1000]
assert [round(s["distance_m"], 2) for s in large] == [2.0] * 4, large
assert {s["last_row"] - s["first_row"] for s in large} == {15} and sum(s["pixels"] for s in large) > 0.97 * len(ringed), large
print("read: list with rings (rosbags, SQLite): 16 rows, 4 walls")
both = [("/camera/camera_info", "sensor_msgs/msg/CameraInfo", 1, info), ("/camera/depth", "sensor_msgs/msg/Image", 1, image),
        ("/points", "sensor_msgs/msg/PointCloud2", 1, cloud)]
write(folder / "both", both)
result = run("segment", folder / "both", "--out", folder / "none")
assert result.returncode == 2 and "--topic" in result.stderr and "/camera/depth" in result.stderr, result.stderr
walls(segment(folder / "both", "--topic", "/camera/depth"), [2.0, 3.0], "depth image (rosbags, SQLite)")

messages = []
for seconds, turn, beams, ranges in laser_rows():
    rotation = T["geometry_msgs/msg/Quaternion"](x=0.0, y=np.sin(-turn / 2), z=0.0, w=np.cos(-turn / 2))
    shift = T["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0)
    transform = T["geometry_msgs/msg/Transform"](translation=shift, rotation=rotation)
    stamped = T["geometry_msgs/msg/TransformStamped"](
        header=header("base", 100 + seconds), child_frame_id="laser", transform=transform)
    messages.append(("/tf", "tf2_msgs/msg/TFMessage", 100 + seconds, T["tf2_msgs/msg/TFMessage"](transforms=[stamped])))
    if ranges is not None:
        scan = T["sensor_msgs/msg/LaserScan"](
            header=header("laser", 100 + seconds), angle_min=beams[0], angle_max=beams[-1], angle_increment=beams[1] - beams[0],
            time_increment=0.0001, scan_time=0.04, range_min=0.1, range_max=30.0, ranges=ranges,
            intensities=np.zeros(0, np.float32))
        messages.append(("/scan", "sensor_msgs/msg/LaserScan", 100 + seconds, scan))
write(folder / "tilted", messages)
walls(segment(folder / "tilted"), [2.0, 3.0], "tilted laser (rosbags, SQLite)")

# ---- mcap-ros2-support: MCAP

from mcap.writer import CompressionType
from mcap_ros2.writer import Writer

CLOUD = """std_msgs/Header header
uint32 height
uint32 width
sensor_msgs/PointField[] fields
bool is_bigendian
uint32 point_step
uint32 row_step
uint8[] data
bool is_dense
===
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
===
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
===
MSG: sensor_msgs/PointField
string name
uint32 offset
uint8 datatype
uint32 count""".replace("===", "=" * 80)
for packed in (False, True):
    path = folder / f"cloud_{'zstd' if packed else 'plain'}.mcap"
    with open(path, "wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD if packed else CompressionType.NONE)
        schema = writer.register_msgdef("sensor_msgs/msg/PointCloud2", CLOUD)
        fields = [{"name": n, "offset": 4 * i, "datatype": 7, "count": 1} for i, n in enumerate("xyz")]
        message = {"header": {"stamp": stamp, "frame_id": "map"}, "height": 60, "width": 80, "fields": fields,
                   "is_bigendian": False, "point_step": 12, "row_step": 960, "data": points.tobytes(), "is_dense": True}
        writer.write_message("/points", schema, message, log_time=1, publish_time=1)
        writer.finish()
    if packed:
        result = run("segment", path, "--out", folder / "none")
        assert result.returncode == 2 and "zstd" in result.stderr, result.stderr
        print(f"refused as it should be: {result.stderr.strip()}")
    else:
        walls(segment(path), [2.0, 3.0], path.name)

# ---- ouster-sdk: packets of its own making

try:
    from ouster.sdk import core, pcap
except ImportError:
    print("without ouster-sdk, which could not be installed")
    sys.exit()
sensor = core.SensorInfo.from_default(core.LidarMode._1024x10)
frame = core.LidarFrame(sensor)
rows, columns = frame.field("RANGE").shape
frame.field("RANGE")[:] = rng.integers(1000, 50_000, (rows, columns))
frame.measurement_id[:] = np.arange(columns)
frame.status[:] = 0xFFFFFFFF
frame.timestamp[:] = 1 + np.arange(columns, dtype=np.uint64)
packets = list(core.frame_to_packets(frame, core.PacketFormat(sensor), sensor.init_id, int(sensor.sn or 0)))
path = folder / "ouster_sdk.pcap"
pcap.record(packets, str(path))
(folder / "ouster_sdk.json").write_text(sensor.to_json_string())
out = folder / "ouster"
# found beside the capture by its name
result = run("segment", path, "--out", out, "--write", "pcd")
assert result.returncode == 0, result.stderr
# their axes are those of the housing, ours those of the lidar
theirs = np.asarray(core.XYZLut(sensor, False)(frame)).reshape(-1, 3)
turn, shift_mm = sensor.lidar_to_sensor_transform[:3, :3], sensor.lidar_to_sensor_transform[:3, 3]
theirs = (theirs - shift_mm / 1000) @ turn
theirs = core.destagger(sensor, theirs.reshape(rows, columns, 3)).reshape(-1, 3)
head, data = (out / "points.pcd").read_bytes().split(b"DATA binary\n", 1)
sizes = [int(n) for n in head.split(b"SIZE ")[1].split(b"\n")[0].split()]
ours = np.frombuffer(data, np.uint8).reshape(-1, sum(sizes))[:, :12].copy().view("<f4")
measured = ~np.isnan(ours[:, 0])
assert measured.mean() > 0.99, measured.sum()
apart = np.linalg.norm(ours - theirs, axis=1)[measured]
print(f"ouster-sdk: {len(ours)} points, median {np.median(apart):.4f} m, at most {apart.max():.4f} m from its own")
# a beam passes beside the origin by no more than this
assert apart.max() < 0.012
