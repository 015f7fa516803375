"""Files, simulated offices and evaluation."""

import pickle

import numpy as np
import pytest

import scanseg


@pytest.mark.parametrize("ending", ["png", "pgm"])
def test_ranges_and_labels_come_back(tmp_path, room, ending):
    beams, ranges = room
    path = tmp_path / f"scan.{ending}"
    scanseg.write_ranges(path, ranges, beams)
    scan = scanseg.read(path, geometry=tmp_path / "scan.toml")
    assert np.allclose(scan.ranges, ranges, atol=0.00051) and scan.remarks == []
    assert scanseg.read(str(path), -1, geometry=str(tmp_path / "scan.toml")).name == str(path)
    labels = np.asfortranarray(np.arange(61 * 121).reshape(61, 121))
    scanseg.write_labels(tmp_path / f"labels.{ending}", labels)
    again = scanseg.read_labels(tmp_path / f"labels.{ending}")
    assert again.dtype == np.uint16 and np.array_equal(again, labels)


def test_arrays_in_files(tmp_path):
    np.save(tmp_path / "depth.npy", np.full((20, 30), 2.0, np.float32))
    file = scanseg.ScanFile(tmp_path / "depth.npy", fx=25)
    assert len(file) == 1 and [scan.ranges.shape for scan in file] == [(20, 30)]
    result = scanseg.segment(file[0].ranges, file[0].beams)
    assert result.segments["distance_m"].round(3).tolist() == [2.0]
    with pytest.raises(IndexError, match="1 of 1"):
        file[1]


def test_what_is_wrong_with_a_file(tmp_path, room):
    beams, ranges = room
    with pytest.raises(FileNotFoundError):
        scanseg.read(tmp_path / "none.pgm")
    with pytest.raises(FileNotFoundError):
        scanseg.Beams.read(tmp_path / "none.toml")
    (tmp_path / "text.pgm").write_text("hello")
    with pytest.raises(ValueError, match="formats"):
        scanseg.read(tmp_path / "text.pgm")
    np.save(tmp_path / "list.npy", np.ones((17, 3)))
    with pytest.raises(ValueError, match="17 points"):
        scanseg.read(tmp_path / "list.npy")
    with pytest.raises(ValueError, match="70000"):
        scanseg.write_labels(tmp_path / "l.png", np.full((2, 2), 70000))
    with pytest.raises(ValueError, match="0.5"):
        scanseg.write_labels(tmp_path / "l.png", np.full((2, 2), 0.5))
    with pytest.raises(ValueError, match="jpg"):
        scanseg.write_labels(tmp_path / "l.jpg", np.ones((2, 2), int))
    with pytest.raises(ValueError, match="65535 counts"):
        scanseg.write_ranges(tmp_path / "r.png", ranges * 1000, beams)
    assert not list(tmp_path.glob("[lr].*"))


@pytest.mark.parametrize("sensor", ["nodding", "spinning", "pinhole"])
def test_an_office_is_found(sensor):
    office = scanseg.office(2, set="validation", sensor=sensor, noise_m=0.005)
    result = scanseg.segment(office.ranges, office.beams)
    hoover = scanseg.evaluate(result.labels, office.truth, min_pixels=30)
    assert hoover.correct > 0.5 * hoover.truth_regions
    assert hoover.truth_regions == len([n for n in np.bincount(office.truth.ravel())[1:] if n >= 30])
    assert scanseg.evaluate(office.truth, office.truth).correct == len(np.unique(office.truth[office.truth > 0]))


def test_what_cannot_be_evaluated():
    labels = np.ones((4, 5), int)
    with pytest.raises(ValueError, match="4 x 5 pixels, but truth has 5 x 4"):
        scanseg.evaluate(labels, labels.T)
    with pytest.raises(ValueError, match="0.5"):
        scanseg.evaluate(labels, labels, tolerance=0.5)
    with pytest.raises(ValueError, match="-1"):
        scanseg.evaluate(-labels, labels)
    with pytest.raises(ValueError, match="-2"):
        scanseg.office(0, noise_m=-2)
    with pytest.raises(ValueError, match="mast"):
        scanseg.office(0, sensor="mast")


def test_evaluation_is_that_of_the_command(command, tmp_path):
    office = scanseg.office(1, noise_m=0.01)
    result = scanseg.segment(office.ranges, office.beams)
    scanseg.write_labels(tmp_path / "truth.png", office.truth)
    scanseg.write_labels(tmp_path / "labels.png", result.labels)
    command("office", "--scene", 1, "--noise-m", 0.01, "--out", tmp_path / "office")
    assert np.array_equal(scanseg.read_labels(tmp_path / "office" / "tuning-01-truth.pgm"), office.truth)
    said = command("evaluate", "--truth", tmp_path / "truth.png", "--labels", tmp_path / "labels.png")
    numbers = dict(line.split() for line in said.splitlines())
    hoover = scanseg.evaluate(result.labels, office.truth)
    assert {name: float(value) for name, value in numbers.items()} == vars(hoover)


def test_results_are_the_files_of_the_command(command, tmp_path, room):
    beams, ranges = room
    scanseg.write_ranges(tmp_path / "scan.png", ranges, beams)
    inputs = [tmp_path / "scan.png", "--geometry", tmp_path / "scan.toml"]
    command("segment", *inputs, "--out", tmp_path / "out", "--write", "ply,pcd,json,csv,geojson")
    scan = scanseg.read(inputs[0], geometry=inputs[2])
    result = scanseg.segment(scan.ranges, scan.beams)
    for name in ["points.ply", "points.pcd"]:
        result.write_points(tmp_path / name)
    for name in ["outlines.ply", "outlines.csv", "outlines.json", "outlines.geojson"]:
        result.write_outlines(tmp_path / name)
    for path in tmp_path.glob("*s.*"):
        assert path.read_bytes() == (tmp_path / "out" / path.name).read_bytes(), path.name
    assert len(list(tmp_path.glob("*s.*"))) == 6
    with pytest.raises(ValueError, match="xyz"):
        result.write_points(tmp_path / "points.xyz")
    with pytest.raises(ValueError, match="txt"):
        result.write_outlines(tmp_path / "outlines.txt")
    with pytest.raises(ValueError, match="pickled"):
        pickle.loads(pickle.dumps(result)).write_points(tmp_path / "p.ply")
    with pytest.raises(OSError):
        result.write_points(tmp_path / "none" / "p.ply")
