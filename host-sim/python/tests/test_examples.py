"""The examples, where the packages that they need are."""

import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import scanseg

EXAMPLES = Path(__file__).parents[1] / "examples"


def needs(*packages):
    for package in packages:
        if find_spec(package) is None:
            pytest.skip(f"no {package}")


def run(name, *arguments):
    done = subprocess.run(
        [sys.executable, EXAMPLES / name, *map(str, arguments)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_tum_frame(tmp_path):
    office = scanseg.office(3, sensor="pinhole", shape=(480, 640), noise_m=0.003)
    forward = office.beams.points(np.ones(office.ranges.shape))[..., 0]
    scanseg.write_labels(tmp_path / "depth.png", np.round(5000 * office.ranges.astype(float) * forward))
    lines = run("tum_frame.py", tmp_path / "depth.png").splitlines()
    assert len(lines) > 4 and sum("planar" in line for line in lines) > 3


def test_ouster_scan(recorded):
    needs("ouster")
    folder = recorded("data/ouster-os1")
    name = "OS-1-128_v2.3.0_1024x10"
    out = run("ouster_scan.py", folder / f"{name}_lb_n3.pcap", folder / f"{name}.json")
    assert out.count("128 x 1024 points") == 3


def test_open3d_display(tmp_path):
    needs("open3d")
    assert "outlines" in run("open3d_display.py", "", tmp_path / "cloud.ply")
    assert (tmp_path / "cloud.ply").stat().st_size > 100_000


def test_gtsam_planes():
    needs("gtsam")
    assert "the pose is found" in run("gtsam_planes.py")


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


def record(path, scans):
    """Write a recording of simulated offices."""
    from mcap.writer import CompressionType
    from mcap_ros2.writer import Writer

    fields = [{"name": name, "offset": 4 * i, "datatype": 7, "count": 1} for i, name in enumerate("xyz")]
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE)
        schema = writer.register_msgdef("sensor_msgs/msg/PointCloud2", CLOUD)
        for n in range(scans):
            office = scanseg.office(n % 25, sensor="pinhole", shape=(90, 120), noise_m=0.005, seed=n)
            cloud = {
                "header": {"stamp": {"sec": n, "nanosec": 0}, "frame_id": "scanner"},
                "height": 90,
                "width": 120,
                "fields": fields,
                "is_bigendian": False,
                "point_step": 12,
                "row_step": 12 * 120,
                "data": office.beams.points(office.ranges).astype("<f4").tobytes(),
                "is_dense": False,
            }
            writer.write_message("/points", schema, cloud, log_time=n, publish_time=n)
        writer.finish()


def test_dask_recording(tmp_path):
    """Workers are processes of their own; one is killed while tasks are left."""
    needs("distributed", "mcap_ros2")
    from distributed import Client

    recording, scheduler_file = tmp_path / "recording.mcap", tmp_path / "scheduler.json"
    record(recording, 60)
    assert "60 scans" in run("dask_recording.py", recording, tmp_path / "alone.npy")
    dask = [sys.executable, "-m", "dask"]
    of_scheduler = ["--scheduler-file", scheduler_file, "--no-dashboard"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    scheduler = [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", *of_scheduler]
    worker = [*dask, "worker", "--host", "127.0.0.1", "--nthreads", "1", "--no-nanny", *of_scheduler]
    processes = [subprocess.Popen(command, **quiet) for command in [scheduler, worker, worker]]
    try:
        with Client(scheduler_file=str(scheduler_file), timeout=60) as client:
            client.wait_for_workers(2, timeout=60)
            address = client.scheduler.address
        arguments = [recording, tmp_path / "cluster.npy", address]
        example = [sys.executable, EXAMPLES / "dask_recording.py", *map(str, arguments)]
        with subprocess.Popen(example, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
            first = running.stdout.readline()
            processes[1].kill()
            rest, said = running.communicate(timeout=120)
        assert first == "1 of 12 tasks\n" and "60 scans" in rest, said
        assert processes[2].poll() is None
    finally:
        for process in processes:
            process.kill()
            process.wait()
    alone, cluster = np.load(tmp_path / "alone.npy"), np.load(tmp_path / "cluster.npy")
    assert len(alone) > 100 and alone.tobytes() == cluster.tobytes()
