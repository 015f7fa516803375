"""Show the segments of a scan with Open3D, or save them: python open3d_display.py [SCAN [OUT.ply]]"""

import sys

import numpy as np
import open3d as o3d

import scanseg

scan = scanseg.read(sys.argv[1]) if sys.argv[1:2] > [""] else scanseg.office(3, noise_m=0.005)
result = scanseg.segment(scan.ranges, scan.beams)

# a colour for each label; grey for none
colours = np.random.default_rng(7).uniform(0.2, 1, (len(result.segments) + 1, 3))
colours[0] = 0.5
returns = result.ranges > 0
cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(result.points()[returns]))
cloud.colors = o3d.utility.Vector3dVector(colours[result.labels[returns]])
shown = [cloud]
for colour, corners in zip(colours[1:], result.polygons):
    if len(corners) > 0:
        outline = o3d.geometry.LineSet(
            o3d.utility.Vector3dVector(corners),
            o3d.utility.Vector2iVector([(i, (i + 1) % len(corners)) for i in range(len(corners))]),
        )
        outline.paint_uniform_color(colour)
        shown.append(outline)

print(f"{returns.sum()} points, {len(shown) - 1} outlines")
if len(sys.argv) > 2:
    o3d.io.write_point_cloud(sys.argv[2], cloud)
else:
    o3d.visualization.draw_geometries(shown)
