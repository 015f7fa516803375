"""What other programs write is read, and what scanseg writes is read by other programs.

    python strangers.py SCANSEG FOLDER
"""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np

try:
    import open3d
except ImportError:
    open3d = None

scanseg, folder = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
ROWS, COLUMNS = 96, 128
NOISE_M = 0.005
rng = np.random.default_rng(14)


def room(directions):
    """Ranges of a room 4 m wide: two walls, a floor, a ceiling, a wall in front with a box before it."""
    planes = [([1, 0, 0], 4.0), ([0, 1, 0], 2.0), ([0, -1, 0], 2.0), ([0, 0, 1], 1.6), ([0, 0, -1], 1.1)]
    ranges = np.full(directions.shape[:2], np.inf)
    for normal, distance_m in planes:
        facing = directions @ np.array(normal, float)
        with np.errstate(divide="ignore"):
            ranges = np.minimum(ranges, np.where(facing > 0, distance_m / facing, np.inf))
    box = (np.abs(directions[..., 1]) < 0.2) & (np.abs(directions[..., 2]) < 0.15) & (directions[..., 0] > 0)
    ranges = np.where(box, 2.5 / directions[..., 0], ranges)
    ranges = ranges + rng.normal(0, NOISE_M, ranges.shape)
    ranges[rng.random(ranges.shape) < 0.02] = np.nan
    return ranges


def camera():
    v, u = np.mgrid[:ROWS, :COLUMNS]
    directions = np.stack([np.ones(u.shape), -(u - 63.5) / 90.0, -(v - 47.5) / 90.0], axis=-1)
    return directions / np.linalg.norm(directions, axis=-1, keepdims=True)


def lidar():
    elevation = np.radians(np.linspace(20, -20, ROWS))[:, None]
    azimuth = np.radians(180 - 360 / COLUMNS * np.arange(COLUMNS))[None, :]
    parts = [np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation) + 0 * azimuth]
    return np.stack(parts, axis=-1)


def run(*arguments):
    return subprocess.run([scanseg, *map(str, arguments)], capture_output=True, text=True)


def segment(path, *arguments):
    """Returns the segments of a file and its folder."""
    out = folder / (Path(path).name + ".out")
    result = run("segment", path, "--out", out, "--range-noise-m", NOISE_M, *arguments)
    assert result.returncode == 0, f"{path}: {result.stderr}"
    return json.loads((out / "segments.json").read_text())["segments"], out


def refused(path, what, *arguments):
    result = run("segment", path, "--out", folder / "none", *arguments)
    assert result.returncode == 2 and what in result.stderr, f"{path}: {result.stderr}"
    print(f"refused as it should be: {Path(path).name}: {result.stderr.strip()}"[:150])


def same(path, truth, *arguments):
    """The same segments as of the truth: sizes within 1 %, planes within a millimetre or so."""
    segments, _ = segment(path, *arguments)
    large = [s for s in segments if s["pixels"] > 200]
    expected = [s for s in truth if s["pixels"] > 200]
    assert len(large) == len(expected) >= 5, f"{path}: {len(large)} segments, not {len(expected)}"
    for found, right in zip(large, expected):
        assert abs(found["pixels"] - right["pixels"]) <= 0.01 * right["pixels"] + 2, f"{path}: {found} {right}"
        assert np.allclose(found["normal"], right["normal"], atol=2e-3), f"{path}: {found} {right}"
        assert abs(found["distance_m"] - right["distance_m"]) < 2e-3, f"{path}: {found} {right}"
    print(f"read: {Path(path).name}, {len(large)} large segments")


# ---- in

directions = camera()
ranges = room(directions)
points = (directions * ranges[..., None]).astype(np.float32)
measured = ~np.isnan(ranges)
np.save(folder / "points.npy", points)
truth, _ = segment(folder / "points.npy")
print(f"numpy: {len(truth)} segments")

depth_m = (ranges * directions[..., 0]).astype(np.float32)
np.save(folder / "depth_f32.npy", depth_m)
same(folder / "depth_f32.npy", truth, "--fx", 90)
counts = np.nan_to_num(depth_m * 10_000).round().astype(np.uint16)
np.save(folder / "depth_u16.npy", counts)
same(folder / "depth_u16.npy", truth, "--fx", 90, "--unit-m", 0.0001)
np.save(folder / "optical.npy", np.stack([-points[..., 1], -points[..., 2], points[..., 0]], axis=-1).astype(np.float64))
same(folder / "optical.npy", truth)
np.save(folder / "list.npy", points.reshape(-1, 3))
refused(folder / "list.npy", "without rows and columns")
np.save(folder / "nothing.npy", np.full_like(points, np.nan))
refused(folder / "nothing.npy", "none of 12288 pixels has a distance")

from plyfile import PlyData, PlyElement

flat = points.reshape(-1, 3)
kinds = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("intensity", "f4")]
vertices = np.array([(*p, 0.5) for p in flat], dtype=kinds)
for text in (True, False):
    for byte_order in "<>":
        name = folder / f"plyfile_{'ascii' if text else byte_order == '<' and 'little' or 'big'}.ply"
        info = [f"num_cols {COLUMNS}", f"num_rows {ROWS}"]
        PlyData([PlyElement.describe(vertices, "vertex")], text=text, byte_order=byte_order, obj_info=info).write(name)
        same(name, truth)
name = folder / "plyfile_grid.ply"
seen = np.flatnonzero(measured.ravel())
grid = np.empty(ROWS * COLUMNS, dtype=[("vertex_indices", "O")])
grid["vertex_indices"] = [np.empty(0, "i4")] * len(grid)
for vertex, pixel in enumerate(seen):
    grid["vertex_indices"][pixel] = np.array([vertex], "i4")
elements = [
    PlyElement.describe(vertices[seen], "vertex"),
    PlyElement.describe(grid, "range_grid", len_types={"vertex_indices": "u1"}, val_types={"vertex_indices": "i4"}),
]
PlyData(elements, obj_info=[f"num_cols {COLUMNS}", f"num_rows {ROWS}"]).write(name)
same(name, truth)
name = folder / "plyfile_list.ply"
PlyData([PlyElement.describe(vertices, "vertex")]).write(name)
refused(name, "without rows and columns")

from pypcd4 import Encoding, PointCloud

cloud = PointCloud.from_xyz_points(flat)
cloud.metadata.width, cloud.metadata.height = COLUMNS, ROWS
for encoding in (Encoding.ASCII, Encoding.BINARY, Encoding.BINARY_COMPRESSED):
    name = folder / f"pypcd4_{encoding.value}.pcd"
    cloud.save(name, encoding=encoding)
    same(name, truth)
name = folder / "pypcd4_list.pcd"
PointCloud.from_xyz_points(flat).save(name)
refused(name, "without rows and columns")

# points without a return left out, each with its ring, as drivers of spinning lidars have them
ring_points = lidar() * room(lidar())[..., None]
rings = np.broadcast_to(np.arange(ROWS)[::-1, None], ring_points.shape[:2])
seen = ~np.isnan(ring_points[..., 0])
listed = np.column_stack([ring_points[seen], rings[seen]]).astype(np.float32)
name = folder / "pypcd4_rings.pcd"
PointCloud.from_points(listed, ("x", "y", "z", "ring"), (np.float32, np.float32, np.float32, np.uint16)).save(name)
np.save(folder / "rings.npy", ring_points)
ring_truth, _ = segment(folder / "rings.npy")
same(name, ring_truth)
for field, kind in (("ring", "u2"), ("channel", "f4")):
    name = folder / f"plyfile_{field}.ply"
    kinds = [("x", "f4"), ("y", "f4"), ("z", "f4"), (field, kind)]
    PlyData([PlyElement.describe(np.array([tuple(p) for p in listed], dtype=kinds), "vertex")]).write(name)
    same(name, ring_truth)
name = folder / "plyfile_one_ring.ply"
of_one = listed[listed[:, 3] == 7]
PlyData([PlyElement.describe(np.array([tuple(p) for p in of_one], dtype=kinds), "vertex")]).write(name)
refused(name, "without rows and columns")

import pye57

lidar_directions = lidar()
lidar_ranges = room(lidar_directions)
lidar_points = lidar_directions * lidar_ranges[..., None]
np.save(folder / "lidar.npy", lidar_points)
lidar_truth, _ = segment(folder / "lidar.npy")
rows, columns = np.nonzero(~np.isnan(lidar_ranges))
data = {f"cartesian{axis}": lidar_points[rows, columns, i] for i, axis in enumerate("XYZ")}
name = folder / "pye57.e57"
with pye57.E57(str(name), mode="w") as file:
    file.write_scan_raw({**data, "rowIndex": rows, "columnIndex": columns}, rotation=np.array([0, 0, 0, 1.0]), translation=np.array([10.0, 20.0, 3.0]))
same(name, lidar_truth)
name = folder / "pye57_list.e57"
with pye57.E57(str(name), mode="w") as file:
    file.write_scan_raw(data)
refused(name, "without rows and columns")

if open3d:
    name = folder / "open3d.png"
    open3d.io.write_image(str(name), open3d.geometry.Image(counts))
    intrinsic = open3d.camera.PinholeCameraIntrinsic(COLUMNS, ROWS, 90.0, 90.0, 63.5, 47.5)
    open3d.io.write_pinhole_camera_intrinsic(str(folder / "open3d.json"), intrinsic)
    same(name, truth, "--geometry", folder / "open3d.json", "--unit-m", 0.0001)
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(flat[measured.ravel()].astype(float)))
    for kind in ("pcd", "ply"):
        name = folder / f"open3d_list.{kind}"
        open3d.io.write_point_cloud(str(name), cloud)
        refused(name, "without rows and columns")

# ---- out

segments, out = segment(folder / "points.npy", "--write", "ply,pcd,json,csv,geojson,mcap")
count = int(measured.sum())
labels = PlyData.read(out / "points.ply")
assert len(labels["vertex"]) == count and len(labels["range_grid"]) == ROWS * COLUMNS
xyz = np.stack([labels["vertex"][axis] for axis in "xyz"], axis=-1)
assert np.allclose(xyz, points[measured], atol=1e-3)
of_label = np.bincount(labels["vertex"]["label"], minlength=len(segments) + 1)
assert [s["pixels"] for s in segments] == list(of_label[1:])
faces = PlyData.read(out / "outlines.ply")
assert len(faces["face"]) == len(json.loads((out / "outlines.json").read_text()))
print("plyfile reads points.ply and outlines.ply")

cloud = PointCloud.from_path(out / "points.pcd")
assert (cloud.metadata.width, cloud.metadata.height) == (COLUMNS, ROWS)
assert np.allclose(cloud.numpy(("x", "y", "z")), flat, atol=1e-3, equal_nan=True)
assert set(PointCloud.decode_rgb(cloud.numpy(("rgb",)).ravel())[:, 0]) != {0}
print("pypcd4 reads points.pcd")

for shown in json.loads((out / "outlines.geojson").read_text())["features"]:
    ring = np.array(shown["geometry"]["coordinates"][0])
    assert np.array_equal(ring[0], ring[-1]) and ring.shape[1] == 3
    assert np.allclose(ring @ shown["properties"]["normal"] + shown["properties"]["distance_m"], 0, atol=1e-4)
corners = list(csv.DictReader((out / "outlines.csv").open()))
assert {int(c["label"]) for c in corners} == {p["label"] for p in json.loads((out / "outlines.json").read_text())}

from mcap_ros2.reader import read_ros2_messages

topics = {}
for message in read_ros2_messages(str(out / "recording.mcap")):
    topics.setdefault(message.channel.topic, []).append(message)
assert len(topics["/rows"]) == ROWS and len(topics["/points"]) == 1
times = [m.log_time_ns for m in topics["/rows"]]
assert times == sorted(times) and len(set(times)) == ROWS
last = topics["/points"][0].ros_msg
assert (last.height, last.width, last.point_step, len(last.data)) == (ROWS, COLUMNS, 20, 20 * ROWS * COLUMNS)
markers = [marker for m in topics["/planes"] for marker in m.ros_msg.markers]
assert len(markers) == len(faces["face"]) and all(m.type == 11 and len(m.points) % 3 == 0 for m in markers)
print(f"mcap-ros2-support reads recording.mcap: {len(markers)} markers")

from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

bag = folder / "bag"
bag.mkdir()
(bag / "recording.mcap").write_bytes((out / "recording.mcap").read_bytes())
with AnyReader([bag / "recording.mcap"], default_typestore=get_typestore(Stores.ROS2_HUMBLE)) as reader:
    kinds = {c.topic: c.msgtype for c in reader.connections}
    for connection, _, raw in reader.messages():
        reader.deserialize(raw, connection.msgtype)
print(f"rosbags reads recording.mcap: {kinds}")

if open3d:
    for name in ("points.pcd", "points.ply"):
        cloud = open3d.io.read_point_cloud(str(out / name), remove_nan_points=True)
        assert len(cloud.points) == count and cloud.has_colors(), name
    mesh = open3d.io.read_triangle_mesh(str(out / "outlines.ply"))
    assert len(mesh.triangles) > 0
    print("open3d reads points.pcd, points.ply and outlines.ply")

same(out / "points.pcd", truth)
same(out / "points.ply", truth)
print("good")
