"""Segment a depth frame of a TUM RGB-D sequence: python tum_frame.py DEPTH.png"""

import sys

import scanseg

# https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats: 5000 counts are a metre
scan = scanseg.read(sys.argv[1], unit_m=1 / 5000, fx=525.0, fy=525.0, cx=319.5, cy=239.5)
result = scanseg.segment(scan.ranges, scan.beams, noise="kinect-v1")

print(f"{len(result.segments)} segments")
for found in result.segments[:10]:
    x, y, z = found["normal"]
    print(
        f"{found['label']:3} {found['pixels']:7} pixels, {found['area_m2']:6.2f} m2, {found['distance_m']:6.3f} m away, "
        f"normal ({x:.2f}, {y:.2f}, {z:.2f}), {found['planarity']}"
    )
