"""`scanseg ros2` between publishers and listeners of Cyclone DDS, on loopback.

    python ros2.py SCANSEG
"""

import os
import re
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass

import numpy as np
from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import array, float32, float64, int32, sequence, uint8, uint32
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.internal import InvalidSample
from cyclonedds.topic import Topic
from cyclonedds.util import duration

SCANSEG = sys.argv[1]
# a domain of its own, so that nobody else's nodes are heard
DOMAIN = 20 + os.getpid() % 180
ROWS, COLUMNS, SENT = 96, 128, 30


def message(package, name):
    return dict(typename=f"{package}::msg::dds_::{name}_")


@dataclass
class Time(IdlStruct, **message("builtin_interfaces", "Time")):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, **message("std_msgs", "Header")):
    stamp: Time
    frame_id: str


@dataclass
class PointField(IdlStruct, **message("sensor_msgs", "PointField")):
    name: str
    offset: uint32
    datatype: uint8
    count: uint32


@dataclass
class PointCloud2(IdlStruct, **message("sensor_msgs", "PointCloud2")):
    header: Header
    height: uint32
    width: uint32
    fields: sequence[PointField]
    is_bigendian: bool
    point_step: uint32
    row_step: uint32
    data: sequence[uint8]
    is_dense: bool


@dataclass
class Image(IdlStruct, **message("sensor_msgs", "Image")):
    header: Header
    height: uint32
    width: uint32
    encoding: str
    is_bigendian: uint8
    step: uint32
    data: sequence[uint8]


@dataclass
class RegionOfInterest(IdlStruct, **message("sensor_msgs", "RegionOfInterest")):
    x_offset: uint32
    y_offset: uint32
    height: uint32
    width: uint32
    do_rectify: bool


@dataclass
class CameraInfo(IdlStruct, **message("sensor_msgs", "CameraInfo")):
    header: Header
    height: uint32
    width: uint32
    distortion_model: str
    d: sequence[float64]
    k: array[float64, 9]
    r: array[float64, 9]
    p: array[float64, 12]
    binning_x: uint32
    binning_y: uint32
    roi: RegionOfInterest


@dataclass
class LaserScan(IdlStruct, **message("sensor_msgs", "LaserScan")):
    header: Header
    angle_min: float32
    angle_max: float32
    angle_increment: float32
    time_increment: float32
    scan_time: float32
    range_min: float32
    range_max: float32
    ranges: sequence[float32]
    intensities: sequence[float32]


@dataclass
class JointState(IdlStruct, **message("sensor_msgs", "JointState")):
    header: Header
    name: sequence[str]
    position: sequence[float64]
    velocity: sequence[float64]
    effort: sequence[float64]


@dataclass
class Vector3(IdlStruct, **message("geometry_msgs", "Vector3")):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, **message("geometry_msgs", "Quaternion")):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct, **message("geometry_msgs", "Pose")):
    position: Vector3
    orientation: Quaternion


@dataclass
class ColorRGBA(IdlStruct, **message("std_msgs", "ColorRGBA")):
    r: float32
    g: float32
    b: float32
    a: float32


@dataclass
class CompressedImage(IdlStruct, **message("sensor_msgs", "CompressedImage")):
    header: Header
    format: str
    data: sequence[uint8]


@dataclass
class UVCoordinate(IdlStruct, **message("visualization_msgs", "UVCoordinate")):
    u: float32
    v: float32


@dataclass
class MeshFile(IdlStruct, **message("visualization_msgs", "MeshFile")):
    filename: str
    data: sequence[uint8]


@dataclass
class Marker(IdlStruct, **message("visualization_msgs", "Marker")):
    header: Header
    ns: str
    id: int32
    type: int32
    action: int32
    pose: Pose
    scale: Vector3
    color: ColorRGBA
    lifetime: Time
    frame_locked: bool
    points: sequence[Vector3]
    colors: sequence[ColorRGBA]
    texture_resource: str
    texture: CompressedImage
    uv_coordinates: sequence[UVCoordinate]
    text: str
    mesh_resource: str
    mesh_file: MeshFile
    mesh_use_embedded_materials: bool


@dataclass
class MarkerArray(IdlStruct, **message("visualization_msgs", "MarkerArray")):
    markers: sequence[Marker]


participant = DomainParticipant(DOMAIN)
SENSOR = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(5))
RELIABLE = Qos(Policy.Reliability.Reliable(duration(milliseconds=100)), Policy.History.KeepLast(100))


def writer(name, kind, qos=SENSOR):
    return DataWriter(participant, Topic(participant, f"rt{name}", kind), qos=qos)


def header(i, frame):
    return Header(Time(1000 + i // 10, i % 10 * 100_000_000), frame)


def number(header):
    return (header.stamp.sec - 1000) * 10 + header.stamp.nanosec // 100_000_000


def depths_m():
    """A wall 2 m ahead, and a board 1.5 m ahead in its middle."""
    v, u = np.mgrid[:ROWS, :COLUMNS]
    depth = np.where((abs(u - 63.5) < 20) & (abs(v - 47.5) < 20), 1.5, 2.0)
    return depth, (u - 63.5) / 90.0, (v - 47.5) / 90.0


def cloud(i):
    depth, x, y = depths_m()
    points = np.stack([x * depth, y * depth, depth], axis=-1).astype("<f4")
    fields = [PointField(name, 4 * n, 7, 1) for n, name in enumerate("xyz")]
    data = list(points.tobytes())
    return PointCloud2(header(i, "optical"), ROWS, COLUMNS, fields, False, 12, 12 * COLUMNS, data, False)


def image(i):
    counts = (1000 * depths_m()[0]).astype("<u2")
    return Image(header(i, "optical"), ROWS, COLUMNS, "16UC1", 0, 2 * COLUMNS, list(counts.tobytes()))


def camera_info(i):
    k = [90.0, 0, 63.5, 0, 90.0, 47.5, 0, 0, 1]
    region = RegionOfInterest(0, 0, 0, 0, False)
    return CameraInfo(header(i, "optical"), ROWS, COLUMNS, "", [], k, [0.0] * 9, [0.0] * 12, 0, 0, region)


def tilt_rad(s):
    """Up and down again in 4 s."""
    return 0.5 - abs(s % 4 - 2) / 2


def laser(i):
    s = 0.05 * i
    beams = 0.01 * (np.arange(101) - 50)
    ranges = 2.0 / (np.cos(beams) * np.cos(tilt_rad(s)))
    at = Header(Time(int(s), round(s % 1 * 1e9)), "laser")
    scan = LaserScan(at, -0.5, 0.5, 0.01, 0, 0.05, 0.1, 30, ranges.tolist(), [])
    return scan, JointState(at, ["tilt"], [-tilt_rad(s)], [], [])


def good(condition, *what):
    if not condition:
        sys.exit("failed: " + " ".join(map(str, what)))


def until(condition, what, seconds=30):
    end = time.monotonic() + seconds
    while not condition():
        good(time.monotonic() < end, what)
        time.sleep(0.02)


def matched(writer):
    return len(writer.get_matched_subscriptions()) > 0


def listen(name, kind, qos):
    return DataReader(participant, Topic(participant, f"rt{name}", kind), qos=qos)


def taken(reader):
    """What has come, without the news that a publisher has gone."""
    return [sample for sample in reader.take(100) if not isinstance(sample, InvalidSample)]


def begin(*arguments):
    environment = {**os.environ, "ROS_DOMAIN_ID": str(DOMAIN)}
    return subprocess.Popen([SCANSEG, "ros2", *arguments], env=environment, stdout=subprocess.PIPE, text=True)


COUNTS = r"lost (\d+) messages, (\d+) too slow, (\d+) strange, (\d+) not sent"


def run(topic, scans, writers, send, pause_s, qos):
    """Sends until the program has enough scans. Returns its last line, and what came of it."""
    points, planes = listen("/scanseg/points", PointCloud2, qos), listen("/scanseg/planes", MarkerArray, qos)
    program = begin(topic, "--scans", str(scans), "--range-noise-m", "0.005")
    try:
        until(lambda: all(map(matched, writers)) and points.get_matched_publications(), f"{topic}: nobody was found")
        clouds, markers, sent = [], [], 0
        while program.poll() is None:
            good(sent < 40 * scans + 100, f"{topic}: {sent} messages, and no end")
            send(sent)
            sent += 1
            time.sleep(pause_s)
            clouds += taken(points)
            markers += taken(planes)
        clouds += taken(points)
        markers += taken(planes)
        lines = program.stdout.read().splitlines()
    finally:
        program.kill()
    good(program.returncode == 0, f"{topic}: exit code {program.returncode}")
    good(len(lines) == scans + 2, lines)
    lost, slow, strange, unsent = map(int, re.search(COUNTS, lines[-1]).groups())
    print(f"{topic}: {sent} messages sent, {scans} scans taken, {lost} lost, {slow} too slow; of theirs {len(clouds)} clouds and {len(markers)} lists of planes came back")
    return lines, clouds, markers, sent, lost + slow, unsent


def points_of(cloud):
    good([field.name for field in cloud.fields] == ["x", "y", "z", "rgb", "label"], cloud.fields)
    kind = np.dtype([("xyz", "<f4", 3), ("rgb", "<u4"), ("label", "<u4")])
    return np.frombuffer(bytes(cloud.data), kind).reshape(cloud.height, cloud.width)


def looks_like_what_was_sent(clouds, markers):
    depth, x, y = depths_m()
    found = points_of(clouds[-1])
    good(np.allclose(found["xyz"], np.stack([x * depth, y * depth, depth], axis=-1), atol=2e-3), "points moved")
    wall, board = found["label"][5, 5], found["label"][48, 64]
    good(wall > 0 and board > 0 and wall != board, "labels", wall, board)
    good((found["label"] == np.where(depth < 1.9, board, wall)).mean() > 0.98, "labels are not those of the surfaces")
    good(clouds[-1].header.frame_id == "optical" and clouds[-1].header.stamp.sec >= 1000, clouds[-1].header)
    planes = markers[-1].markers
    good(planes[0].action == 3 and len(planes) == 3, "markers", len(planes))
    far = sorted(round(float(np.mean([corner.z for corner in plane.points])), 2) for plane in planes[1:])
    good(far == [1.5, 2.0], far)


clouds_writer = writer("/points", PointCloud2)
lines, clouds, markers, sent, lost, unsent = run(
    "/points", SENT, [clouds_writer], lambda i: clouds_writer.write(cloud(i)), 0.02, RELIABLE)
# each message is a scan, or was counted as lost, or came before the first or after the last one
good(SENT + lost <= sent, sent, lost)
good(len(clouds) + unsent >= 0.8 * SENT and len(markers) + unsent >= 0.8 * SENT, "lost on the way back", len(clouds), len(markers))
looks_like_what_was_sent(clouds, markers)


def what_is_missing_is_counted():
    """Messages come faster than they are segmented."""
    points, sent, back, lines = listen("/scanseg/points", PointCloud2, RELIABLE), 0, [], []
    program = begin("/points", "--range-noise-m", "0.005")
    reading = threading.Thread(target=lambda: lines.extend(line for line in program.stdout if line.startswith("scan ")))
    reading.start()

    def take_back():
        back.extend(number(cloud.header) for cloud in taken(points))

    def counted():
        """Returns how many messages are accounted for, and how many of these are missing. None is on its way."""
        nonlocal sent
        first = sent
        while not back or back[-1] != sent - 1:
            good(sent < first + 50, "nothing comes back")
            clouds_writer.write(cloud(sent))
            sent += 1
            end = time.monotonic() + 5
            while time.monotonic() < end and (not back or back[-1] != sent - 1):
                time.sleep(0.02)
                take_back()
        # a scan's line is written after its cloud is sent
        time.sleep(1)
        lost, slow, *_ = map(int, re.search(COUNTS, lines[-1]).groups())
        return len(lines) + lost + slow, lost + slow

    try:
        until(lambda: points.get_matched_publications() and matched(clouds_writer), "nobody was found")
        # messages and scans before both sides know each other may get lost without a count
        counted_before, missing_before = counted()
        sent_before = sent
        while back[-1] - sent_before + 1 < len([i for i in back if i >= sent_before]) + 5:
            good(sent < 1000, "nothing is lost")
            at_once = [cloud(i) for i in range(sent, sent + 40)]
            for message in at_once:
                clouds_writer.write(message)
                take_back()
            sent += 40
            # until all that waits has come back
            time.sleep(1)
            take_back()
        counted_after, missing_after = counted()
        program.send_signal(signal.SIGINT)
        good(program.wait() == 0, f"exit code {program.returncode}")
    finally:
        program.kill()
        reading.join()
    all_sent, missing = sent - sent_before, missing_after - missing_before
    print(f"/points, at once: {all_sent} messages sent, {missing} lost or too slow")
    good(missing >= 5 and counted_after - counted_before == all_sent, "what is missing is not what was counted", counted_after - counted_before)


what_is_missing_is_counted()

images_writer, camera_writer = writer("/camera/image", Image, RELIABLE), writer("/camera/camera_info", CameraInfo, RELIABLE)


def send_image(i):
    camera_writer.write(camera_info(i))
    images_writer.write(image(i))


lines, clouds, markers, *_ = run("/camera/image", 10, [images_writer, camera_writer], send_image, 0.05, SENSOR)
good(len(clouds) > 0 and len(markers) > 0, "nothing came back by best effort")
looks_like_what_was_sent(clouds, markers)

laser_writer, joints_writer = writer("/scan", LaserScan), writer("/joint_states", JointState, RELIABLE)


def send_row(i):
    scan, joints = laser(i)
    laser_writer.write(scan)
    joints_writer.write(joints)


rows = listen("/scanseg/rows", PointCloud2, Qos(Policy.Reliability.Reliable(duration(milliseconds=100)), Policy.History.KeepAll))
lines, clouds, markers, *_ = run("/scan", 3, [laser_writer, joints_writer], send_row, 0.01, RELIABLE)
good(len(clouds) == 3, "sweeps", len(clouds))
found = points_of(clouds[-1])
good(found.shape[1] == 101 and 35 <= found.shape[0] <= 44, found.shape)
good(np.allclose(found["xyz"][..., 0], 2.0, atol=0.02), "the wall is not flat")
good(clouds[-1].header.frame_id == "laser", clouds[-1].header)
# rows came while their sweep went on; the last ones may be on their way when the program ends
rows = [row for row in rows.take(1000) if not isinstance(row, InvalidSample)]
whole = sum(cloud.height for cloud in clouds)
print(f"/scan: {len(rows)} rows came back")
good(whole - 5 <= len(rows) <= whole + 60, "rows", len(rows), whole)
sent_ns = [row.sample_info.source_timestamp for row in rows]
good(sent_ns == sorted(sent_ns) and sent_ns[0] > 0, "order of the rows")
before = sum(ns < clouds[0].sample_info.source_timestamp for ns in sent_ns)
good(clouds[0].height - 5 <= before, "rows before their sweep", before, clouds[0].height)
good(sent_ns[clouds[0].height // 2] + 50_000_000 < clouds[0].sample_info.source_timestamp, "rows at the end of their sweep")
rows = [points_of(row) for row in rows]
good(all(row.shape == (1, 101) for row in rows), "rows")
good(np.mean([row["label"] > 0 for row in rows]) > 0.95, "rows without labels")
good(np.allclose([row["xyz"][..., 0] for row in rows], 2.0, atol=0.02), "rows are not on the wall")
print("good")
