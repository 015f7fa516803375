"""Rows one at a time."""

import numpy as np
import pytest

import scanseg


def joined(labels, joins):
    labels = labels.copy()
    for source, target in joins:
        labels[labels == source] = target
    return labels


@pytest.mark.parametrize("approach", ["plane", "edge", "region"])
def test_rows_have_the_labels_of_the_image(room, approach):
    beams, ranges = room
    segmenter = scanseg.Segmenter(beams, noise=0.005, approach=approach)
    assert segmenter.columns == 121
    for _ in range(2):  # two scans, one after the other
        labels, joins, segments, next_row = [], [], {}, 0
        for row in [*ranges, None]:
            out = segmenter.finish() if row is None else segmenter.push(row)
            assert out.first_row == (next_row if len(out.labels) else None)
            next_row += len(out.labels)
            labels.append(out.labels)
            joins += out.joins.tolist()
            segments.update((int(s["label"]), s) for s in out.segments)
            for source, _ in out.joins:
                segments.pop(int(source), None)
        labels = joined(np.concatenate(labels), joins)
        whole = scanseg.segment(ranges, beams, noise=0.005, approach=approach, min_pixels=1)
        assert labels.shape == whole.labels.shape and len(segments) == len(whole.segments)
        for segment in whole.segments:
            label = np.unique(labels[whole.labels == segment["label"]])
            assert len(label) == 1
            same = segments[int(label[0])]
            for name in set(scanseg.SEGMENT.names) - {"label"}:
                assert np.array_equal(same[name], segment[name], equal_nan=True)


def test_segments_come_before_the_scan_ends(room):
    beams, ranges = room
    seen = []

    def rows():
        for row in ranges:
            seen.append(row)
            yield row

    # a box that ends above the last rows
    ranges = ranges.copy()
    ranges[10:25, 50:70] = 1.0 / (beams.points(np.ones((61, 121)))[10:25, 50:70, 0])
    arrived = [(len(seen), s["distance_m"]) for s in scanseg.Segmenter(beams, noise=0.005).segments(rows())]
    at, distance_m = arrived[0]
    assert at < 40 and distance_m == pytest.approx(1.0, abs=2e-3)


def test_the_turn_may_come_with_the_row(room):
    beams, ranges = room
    beam_deg, turn_deg = np.linspace(-60, 60, 121), np.linspace(20, -40, 61)
    segmenter = scanseg.Segmenter(scanseg.Beams.nodding(beam_deg), noise=0.005)
    found = list(segmenter.segments(zip(ranges, turn_deg)))
    expected = list(scanseg.Segmenter(beams, noise=0.005).segments(ranges))
    assert len(found) == len(expected) >= 3
    for a, b in zip(found, expected):
        assert a["pixels"] == b["pixels"] and np.array_equal(a["normal"], b["normal"])


def test_what_is_wrong_is_said_and_changes_nothing(room):
    beams, ranges = room
    segmenter = scanseg.Segmenter(beams, noise=0.005)
    with pytest.raises(ValueError, match="120"):
        segmenter.push(ranges[0][1:])
    with pytest.raises(ValueError, match="int64"):
        segmenter.push(np.ones(121, np.int64))
    assert len(list(segmenter.segments(ranges))) >= 3
    for row in ranges:
        segmenter.push(row)
    with pytest.raises(ValueError, match="row 61 of 61"):
        segmenter.push(ranges[0])
    with pytest.raises(ValueError, match="row 0 of 0"):
        scanseg.Segmenter(scanseg.Beams.nodding([0, 1])).push([1, 1.5])
    with pytest.raises(ValueError, match="pinhole"):
        scanseg.Segmenter(scanseg.Beams.pinhole(9, 9, 0, 0))
    with pytest.raises(ValueError, match="0.5"):
        scanseg.Segmenter(scanseg.Beams.pinhole(9, 9, 0, 0), 2).push([1, 1.5], 0.5)
    with pytest.raises(ValueError, match="99999"):
        scanseg.Segmenter(scanseg.Beams.pinhole(9, 9, 0, 0), 99999)


def test_counts_have_the_unit_of_the_beams():
    toml = "version = 1\nunit_m = 0.001\nkind = 'pinhole'\nfx = 50\nfy = 50\ncx = 19.5\ncy = 9.5\ndepth = 'z'\n"
    beams = scanseg.Beams.from_toml(toml)
    segmenter = scanseg.Segmenter(beams, 40)
    (segment,) = segmenter.segments(np.full((20, 40), 2000, np.uint16))
    assert segment["pixels"] == 800 and segment["distance_m"] == pytest.approx(2, abs=1e-3)
