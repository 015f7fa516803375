"""Segment all scans of a long recording, in this process or on a Dask cluster.

python dask_recording.py RECORDING.mcap OUT.npy [SCHEDULER]

SCHEDULER is the address of a Dask scheduler, such as tcp://127.0.0.1:8786, whose workers can read the recording
under the same path. OUT.npy gets the segments of all scans: the fields of `scanseg.SEGMENT` and more, and `scan`.
"""

import sys

import numpy as np
from distributed import Client, as_completed

import scanseg

SCANS = 5  # of a task


def segment(path, first, last):
    """Return the segments of scans first to last - 1."""
    file = scanseg.ScanFile(path)
    found = []
    for n in range(first, last):
        scan = file[n]
        segments = scanseg.segment(scan.ranges, scan.beams).segments
        array = np.empty(len(segments), [("scan", "u4"), *segments.dtype.descr])
        array["scan"] = n
        for name in segments.dtype.names:
            array[name] = segments[name]
        found.append(array)
    return np.concatenate(found)


def main(path, out, scheduler=None):
    scans = len(scanseg.ScanFile(path))
    tasks = [(path, first, min(first + SCANS, scans)) for first in range(0, scans, SCANS)]
    if scheduler is None:
        results = [segment(*task) for task in tasks]
    else:
        with Client(scheduler) as client:
            # a task whose worker is lost goes to another one
            futures = client.map(segment, *zip(*tasks), pure=False)
            for done, _ in enumerate(as_completed(futures), start=1):
                print(f"{done} of {len(tasks)} tasks", flush=True)
            results = client.gather(futures)
    segments = np.concatenate(results)
    np.save(out, segments)
    print(f"{scans} scans, {len(segments)} segments")


if __name__ == "__main__":
    main(*sys.argv[1:])
