#!/usr/bin/env python3
"""Asks a running boxgrasp-server for grasps:  plan_grasps.py CLOUD.xyz   (three numbers a line, metres)

The types are made by:  lcm-gen --python --ppath types /usr/share/boxgrasp/lcmtypes/*.lcm
"""
import struct
import sys
import time
import uuid

sys.path[:0] = ["types"]
from boxgrasp import plan_request_t, plan_response_t
from boxgrasp_lcm import Lcm
from drake import lcmt_point_cloud, lcmt_point_cloud_field


def point_cloud(points):
    cloud = lcmt_point_cloud()
    cloud.frame_name, cloud.width, cloud.height = "camera", len(points), 1
    for i, name in enumerate("xyz"):
        field = lcmt_point_cloud_field()
        field.name, field.byte_offset, field.datatype, field.count = name, 4 * i, field.FLOAT32, 1
        cloud.fields.append(field)
    cloud.num_fields, cloud.point_step, cloud.row_step = 3, 12, 12 * len(points)
    cloud.filler, cloud.data = b"", b"".join(struct.pack("<fff", *point) for point in points)
    cloud.data_size = len(cloud.data)
    return cloud


with open(sys.argv[1]) as file:
    points = [tuple(map(float, line.split()[:3])) for line in file if line.strip() and line[0] != "#"]
request = plan_request_t()
request.utime, request.request_id = int(time.time() * 1e6), str(uuid.uuid4())
request.cloud, request.object, request.top_k = point_cloud(points), -1, 5
lcm, answer = Lcm(), None
for _ in range(10):  # LCM may lose messages: the same id is planned once, however often it is sent
    lcm.publish("BOXGRASP_PLAN_REQUEST", request.encode())
    end = time.monotonic() + 2
    while time.monotonic() < end and not (answer and answer.request_id == request.request_id):
        payload = lcm.receive("BOXGRASP_PLAN_RESPONSE", end - time.monotonic())
        answer = plan_response_t.decode(payload) if payload else None
    if answer:
        break
print(answer.message if answer else "no server answers", file=sys.stderr)
for grasp in answer.grasps if answer else []:
    print(f"score {grasp.score:.3f}  palm at", *(f"{x:.4f}" for x in grasp.palm_position_m), "m")
sys.exit(0 if answer and answer.grasps else 4 if not answer else 1)
