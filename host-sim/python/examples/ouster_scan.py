"""Segment the scans of an Ouster as ouster-sdk reads them: python ouster_scan.py CAPTURE.pcap METADATA.json"""

import sys

from ouster.sdk import open_source
from ouster.sdk.core import ChanField, XYZLut, destagger

import scanseg

source = open_source(sys.argv[1], meta=[sys.argv[2]])
for (scan,) in source:
    info = scan.sensor_info
    # columns of one direction below one another: rows x columns x 3, (0, 0, 0) without a return
    xyz = destagger(info, XYZLut(info, use_extrinsics=False)(scan.field(ChanField.RANGE)))
    result = scanseg.segment_cloud(xyz, noise="ouster-os1")
    largest = result.segments[0]
    print(f"{xyz.shape[0]} x {xyz.shape[1]} points by {result.beams.kind} beams: {len(result.segments)} segments")
    print(f"the largest has {largest['pixels']} pixels, {largest['distance_m']:.2f} m away")
