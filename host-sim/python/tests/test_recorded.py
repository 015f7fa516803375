"""Recorded scans: labels equal those of the command."""

import numpy as np
import pytest

import scanseg

KINECT = {"noise": "kinect-v1"}
# path in ../shared, geometry file, further arguments of `read`, arguments of `segment`
SCANS = [
    ("data/tilting-sick-corridor/scan000.range_mm.pgm", "geometry.toml", {}, {}),
    ("data/tilting-sick-corridor/scan001.range_mm.pgm", "geometry.toml", {}, {}),
    ("data/tilting-sick-corridor/scan000.range_mm.pgm", "geometry.toml", {}, {"noise": 0.02}),
    ("data/tilting-sick-corridor/scan000.range_mm.pgm", "geometry.toml", {}, {"approach": "edge"}),
    ("data/tilting-sick-corridor/scan000.range_mm.pgm", "geometry.toml", {}, {"approach": "region"}),
    ("data/office-room-scan/room_scan1.range_mm.pgm", "geometry.toml", {}, {}),
    ("data/office-room-scan/room_scan1.range_mm.pgm", "geometry.toml", {}, {"max_range_m": 3.0}),
    ("data/office1-kinect/office1.depth_mm.pgm", "geometry.toml", {}, {}),
    ("data/office1-kinect/office1.depth_mm.pgm", "geometry.toml", {}, KINECT),
    ("data/office1-kinect/office1.depth_mm.pgm", "geometry.toml", {}, {"approach": "region"}),
    ("data/office1-kinect/office1.pcd", None, {}, {}),
    ("data/ouster-os0/range.pgm", "geometry.toml", {}, {}),
    ("data/ouster-os0/range.pgm", "geometry.toml", {}, {"approach": "edge"}),
    ("data/ouster-os0/OS-0-128-U1_v2.3.0_1024x10.pcap", None, {}, {}),
    ("data/ouster-os1/OS-1-128_v2.3.0_1024x10_lb_n3.pcap", None, {"frame": 1}, {}),
    ("data/ouster-os1/OS-1-32-G_v2.1.1_1024x10.pcap", None, {}, {}),
    ("data/synpeb/test_100.range_100um.pgm", "test_100.geometry.toml", {}, {}),
    ("data/synpeb/test_100.pcd", None, {}, {}),
    ("data/bearing-angle-reference/laserscan-depth.png", "laserscan.geometry.toml", {}, {}),
    ("data/bearing-angle-reference/pinhole-depth.png", "pinhole.geometry.toml", {}, {}),
    ("data/ld06-uart/ld06_example3.bin", None, {}, {}),
    ("cases/01-wide-wall/wall.pgm", "wall.toml", {}, {}),
    ("cases/02-square-wall/floorwall.pgm", "floorwall.toml", {}, {}),
    ("cases/03-noise-grows/kinect.pgm", "kinect_0.02.toml", {}, {}),
    ("cases/06-azimuth-offset-per-row/delivered.pgm", "vlp32c.toml", {}, {}),
    ("cases/09-label-table-full/canopy.pgm", "canopy.toml", {}, {}),
    ("cases/10-cost-grows-with-columns/tile.pgm", "tile_x1.toml", {}, {}),
    ("cases/13-unit-mistake-silent/mm.pgm", "unit_micrometres.toml", {}, {}),
    ("cases/15-organised-cloud/table.pcd", None, {}, {}),
]


@pytest.mark.parametrize(("scan", "geometry", "reading", "settings"), SCANS)
def test_labels_are_those_of_the_command(recorded, command, tmp_path, scan, geometry, reading, settings):
    path = recorded(scan)
    arguments = ["segment", path, "--out", tmp_path]
    if geometry:
        geometry = path.parent / geometry
        arguments += ["--geometry", geometry]
    arguments += [word for name, value in reading.items() for word in (f"--{name}", value)]
    for name, value in settings.items():
        option = {"noise": "sensor" if isinstance(value, str) else "range-noise-m"}.get(name, name.replace("_", "-"))
        arguments += [f"--{option}", value]
    command(*arguments)
    expected = scanseg.read_labels(tmp_path / "labels.png")
    read = scanseg.read(path, geometry=geometry, **reading)
    result = scanseg.segment(read.ranges, read.beams, **settings)
    assert np.array_equal(result.labels, expected)
    if geometry:
        counts = scanseg.segment(scanseg.read_labels(path), scanseg.Beams.read(geometry), **settings)
        assert np.array_equal(counts.labels, expected)
    table = np.genfromtxt(tmp_path / "segments.csv", delimiter=",", names=True, dtype=None, encoding=None)
    table = np.atleast_1d(table)
    assert len(table) == len(result.segments)
    for name in ["pixels", "first_row", "last_row", "first_column", "last_column", "planarity", "residual_per_noise"]:
        ours = result.segments[name]
        same = ours == table[name].astype(ours.dtype)
        assert np.all(same | (table[name] != table[name]))


@pytest.mark.parametrize("approach", ["plane", "edge", "region"])
def test_rows_of_a_recorded_scan_have_the_same_segments(recorded, approach):
    path = recorded("data/tilting-sick-corridor/scan000.range_mm.pgm")
    beams = scanseg.Beams.read(path.parent / "geometry.toml")
    counts = scanseg.read_labels(path)
    whole = scanseg.segment(counts, beams, approach=approach, min_pixels=1)
    void, found = set(), {}
    segmenter = scanseg.Segmenter(beams, counts.shape[1], approach=approach)
    for row in [*counts, None]:
        out = segmenter.finish() if row is None else segmenter.push(row)
        void.update(out.joins[:, 0].tolist())
        found.update((int(s["label"]), int(s["pixels"])) for s in out.segments)
    left = [pixels for label, pixels in found.items() if label not in void]
    assert sorted(left, reverse=True) == whole.segments["pixels"].tolist()
