#!/usr/bin/env python3
"""Reads a tlog with pymavlink and says what is in it, as JSON.

tlog.py FILE
"""

import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"
os.environ["MAVLINK_DIALECT"] = "common"
from pymavlink import mavutil

log = mavutil.mavlink_connection(sys.argv[1], robust_parsing=True)
senders, stamps, bad = {}, [], 0
while (message := log.recv_msg()) is not None:
    if message.get_type() == "BAD_DATA":
        bad += 1
        continue
    stamps.append(message._timestamp)
    counts = senders.setdefault(str(message.get_srcComponent()), {})
    counts[message.get_type()] = counts.get(message.get_type(), 0) + 1
ordered = all(a <= b for a, b in zip(stamps, stamps[1:]))
if not stamps or not ordered:
    sys.exit(f"{len(stamps)} stamps, in order: {ordered}")
print(json.dumps({"from": senders, "bad": bad, "span_s": stamps[-1] - stamps[0], "age_s": time.time() - stamps[-1]}))
