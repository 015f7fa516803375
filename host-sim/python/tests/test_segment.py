"""Whole images."""

import pickle
import threading

import numpy as np
import pytest

import scanseg

NORMALS = {(-1, 0, 0): 3.0, (0, -1, 0): 1.5, (0, 0, 1): 1.2}


def check_room(result):
    assert len(result.segments) == 3
    for segment, polygon in zip(result.segments, result.polygons):
        normal = tuple(int(x) for x in segment["normal"].round())
        assert segment["distance_m"] == pytest.approx(NORMALS[normal], abs=2e-3)
        assert (result.labels == segment["label"]).sum() == segment["pixels"]
        rows, columns = np.nonzero(result.labels == segment["label"])
        assert (rows.min(), rows.max()) == (segment["first_row"], segment["last_row"])
        assert (columns.min(), columns.max()) == (segment["first_column"], segment["last_column"])
        assert segment["planarity"] == "planar" and segment["rms_m"] < 1e-3
        covariance = segment["covariance"]
        assert np.array_equal(covariance, covariance.T) and np.all(np.diag(covariance) > 0)
        assert np.allclose(polygon @ segment["normal"], -segment["distance_m"], atol=1e-3)
        assert segment["area_m2"] > 0.5


def test_a_corner_is_three_planes(room):
    beams, ranges = room
    check_room(scanseg.segment(ranges, beams, noise=0.005))


@pytest.mark.parametrize("approach", ["plane", "edge", "region"])
def test_every_approach(room, approach):
    beams, ranges = room
    result = scanseg.segment(ranges, beams, noise=0.005, approach=approach)
    assert {tuple(s["normal"].round().astype(int)) for s in result.segments[:3]} == set(NORMALS)
    assert np.all((result.labels == 0) | ~result.edges)


def test_arrays_of_every_kind_are_the_same(room):
    beams, ranges = room
    ranges = np.round(ranges, 3)
    holes = np.zeros(ranges.shape, bool)
    holes[5:9, 20:30] = True
    ranges[holes] = np.nan
    expected = scanseg.segment(ranges.astype(np.float32), beams, noise=0.005)
    assert expected.labels.dtype == np.uint32 and np.all(expected.labels[holes] == 0)
    counts = np.where(holes, 0, np.round(ranges * 1000)).astype(np.uint16)
    strided = np.zeros((61, 242))
    strided[:, ::2] = ranges
    for kind, unit_m in [
        (ranges, None),
        (np.asfortranarray(ranges), None),
        (np.asfortranarray(ranges.astype(np.float32)), None),
        (strided[:, ::2], None),
        (ranges.astype(">f4"), None),
        (ranges * 1000, 0.001),
        (np.ma.masked_array(np.where(holes, 1.0, ranges), holes), None),
        (np.ma.masked_array(np.where(holes, 77, counts), holes), 0.001),
        (np.where(holes, np.inf, ranges), None),
        (np.where(holes, -1, ranges), None),
        (counts, 0.001),
        (np.asfortranarray(counts.astype(np.int64)), 0.001),
        (ranges.tolist(), None),
    ]:
        result = scanseg.segment(kind, beams, noise=0.005, unit_m=unit_m)
        assert np.array_equal(result.labels, expected.labels)
        assert np.allclose(result.ranges, expected.ranges, atol=1e-6)


def test_depths_and_clouds_are_the_same_scan():
    u, v = np.meshgrid(np.arange(80), np.arange(60))
    x, y = (u - 39.5) / 70, (v - 29.5) / 70
    with np.errstate(divide="ignore"):
        depth = np.minimum(2.0 / np.maximum(x + 0.6, 1e-9), np.where(y > 0, 0.8 / y, np.inf)).clip(0, 6)
    depth[depth == 6] = 0
    by_depth = scanseg.segment_depth(depth, 70, 70, 39.5, 29.5, noise=0.005)
    assert len(by_depth.segments) >= 2
    points = by_depth.points()
    forward = scanseg.segment_cloud(points, noise=0.005)
    assert forward.beams.kind == "pinhole" and np.array_equal(forward.labels, by_depth.labels)
    optical = np.stack([x * depth, y * depth, depth], axis=2)
    optical[depth == 0] = np.nan
    assert np.array_equal(scanseg.segment_cloud(optical, noise=0.005).labels, by_depth.labels)
    masked = np.ma.masked_invalid(np.asfortranarray(optical))
    assert np.array_equal(scanseg.segment_cloud(masked, noise=0.005).labels, by_depth.labels)
    millimetres = scanseg.segment_depth((depth * 1000).astype(np.uint16), 70, 70, 39.5, 29.5, unit_m=0.001)
    assert len(millimetres.segments) >= 2


def test_noise_is_measured_or_stated(room):
    beams, ranges = room
    noisy = ranges + np.random.default_rng(1).normal(0, 0.01, ranges.shape)
    measured = scanseg.segment(noisy, beams)
    assert 0.008 < measured.noise_m < 0.02 and 1 < measured.noise_range_m < 4
    sensor = scanseg.segment(noisy, beams, noise="sick-lms200")
    assert len(sensor.segments) == 3 and "range_noise_m" in sensor.beams.to_toml()


def test_beams_that_are_off_in_scale_are_found():
    beam_deg, turn_deg = np.linspace(-80, 80, 321), np.linspace(-20, 40, 121)
    beam, turn = np.radians(beam_deg)[None, :], np.radians(turn_deg)[:, None]
    forward = np.cos(beam) * np.cos(turn)
    # a wall ahead, 3 m away, one 2 m to the left, and one 2 m to the right
    with np.errstate(divide="ignore"):
        ranges = np.minimum(3 / forward, 2 / np.abs(np.sin(beam)))
    for factor in (1.0, 1.02, 0.98):
        found = scanseg.segment(ranges, scanseg.Beams.nodding(beam_deg / factor, turn_deg), noise=0.005).beam_stretch
        assert found == pytest.approx(factor - 1, abs=2e-3)
        assert factor != 1 or found == 0


@pytest.mark.parametrize(
    ("number", "call"),
    [
        ("-0.5", lambda r, b: scanseg.segment(r, b, noise=-0.5)),
        ("NaN", lambda r, b: scanseg.segment(r, b, noise=float("nan"))),
        ("kinect-v7", lambda r, b: scanseg.segment(r, b, noise="kinect-v7")),
        ("planes", lambda r, b: scanseg.segment(r, b, approach="planes")),
        ("-7", lambda r, b: scanseg.segment(r, b, unit_m=-7)),
        ("900", lambda r, b: scanseg.segment(r, b, max_range_m=900)),
        ("-3", lambda r, b: scanseg.segment(r, b, min_range_m=-3)),
        ("[61]", lambda r, b: scanseg.segment(r[:, 0], b)),
        ("121 angles, the image has 120", lambda r, b: scanseg.segment(r[:, 1:], b)),
        ("61 angles, the image has 60", lambda r, b: scanseg.segment(r[1:], b)),
        ("uint16", lambda r, b: scanseg.segment(np.ones((61, 121), np.uint16), b)),
        ("complex128", lambda r, b: scanseg.segment(r * 1j, b)),
        ("bool", lambda r, b: scanseg.segment(r > 0, b)),
        ("0 rows x 4 columns", lambda r, b: scanseg.segment(np.ones((0, 4)), scanseg.Beams.pinhole(9, 9, 0, 0))),
        ("16385", lambda r, b: scanseg.segment(np.ones((1, 16385)), scanseg.Beams.pinhole(9, 9, 0, 0))),
        ("[4, 4]", lambda r, b: scanseg.segment_cloud(np.ones((4, 4)))),
        ("[4, 4, 4]", lambda r, b: scanseg.segment_cloud(np.ones((4, 4, 4)))),
        ("none of 16", lambda r, b: scanseg.segment_cloud(np.full((4, 4, 3), np.nan))),
        ("-2", lambda r, b: scanseg.segment_cloud(np.ones((4, 4, 3)), unit_m=-2)),
        ("0.0", lambda r, b: scanseg.segment_depth(r, 0, 500, 1, 1)),
        ("[3, 1]", lambda r, b: scanseg.Beams.nodding(np.ones((3, 1)), [0])),
        ("40000", lambda r, b: scanseg.Beams.spinning([0, 40000], [0])),
        ("55", lambda r, b: scanseg.Beams.nodding([0, 1], [0, 1], lever_arm_m=55)),
        ("'w'", lambda r, b: scanseg.Beams.nodding([0, 1], [0, 1], axis="w")),
        ("61 angles, the image has 3", lambda r, b: b.points(np.ones((3, 121)))),
    ],
)
def test_an_error_has_the_number_in_it(room, number, call):
    beams, ranges = room
    with pytest.raises(ValueError) as error:
        call(ranges, beams)
    assert number in str(error.value)


def test_beams_are_values(room):
    beams, _ = room
    camera = scanseg.Beams.pinhole(9, 8, 7, 6)
    toml = scanseg.Beams.from_toml(beams.to_toml())
    free = scanseg.Beams.free(beams.points(np.ones((61, 121))))
    without_turns = scanseg.Beams.nodding([0, 1])
    for value in [beams, camera, toml, free, without_turns]:
        assert pickle.loads(pickle.dumps(value)) == value
    assert camera != scanseg.Beams.pinhole(9, 8, 7, 5)
    assert "61 rows x 121 columns" in repr(beams)
    with pytest.raises(ValueError, match="free"):
        free.to_toml()


def test_results_can_be_pickled(room):
    beams, ranges = room
    result = scanseg.segment(ranges, beams, noise=0.005)
    again = pickle.loads(pickle.dumps(result))
    assert np.array_equal(again.labels, result.labels) and again.beams == result.beams


def test_free_beams_find_the_same(room):
    beams, ranges = room
    free = scanseg.Beams.free(beams.points(np.ones(ranges.shape)))
    check_room(scanseg.segment(ranges, free, noise=0.005))


def test_the_lock_is_released(room):
    """This thread segments small images while another one segments a large one.

    With the lock held this one would get no further than a few, before the other one has begun.
    """
    beams, ranges = room
    begun, done = threading.Event(), threading.Event()
    camera, wall = scanseg.Beams.pinhole(500, 500, 500, 500), np.full((1000, 1000), 3.0)

    def large():
        begun.set()
        scanseg.segment(wall, camera, noise=0.01)
        done.set()

    thread = threading.Thread(target=large)
    thread.start()
    begun.wait()
    small = 0
    while not done.is_set():
        scanseg.segment(ranges, beams, noise=0.01)
        small += 1
    thread.join()
    assert small > 12
