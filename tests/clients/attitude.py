#!/usr/bin/env python3
"""Listens to irhorizond with pymavlink and says what it heard.

attitude.py --listen 127.0.0.1:14550 --seconds 5 --json     for a udpout endpoint
attitude.py --connect 127.0.0.1:14550 --seconds 5 --json    for a udpin endpoint

The first second that counts begins with the first good message. SIGTERM ends the listening early.
Exit status 0 when there was one, 1 when there was none.
"""

import argparse
import csv
import json
import math
import os
import signal
import subprocess
import sys
import time

os.environ["MAVLINK20"] = "1"
os.environ["MAVLINK_DIALECT"] = "common"
try:
    from pymavlink import mavutil
except ImportError:
    # With another Python than the one that has pymavlink: fetch that one, once.
    setup = os.path.join(os.path.dirname(os.path.abspath(__file__)), "setup")
    python = subprocess.run([setup], check=True, stdout=subprocess.PIPE, text=True).stdout.strip()
    if os.path.realpath(sys.prefix) == os.path.realpath(os.path.dirname(os.path.dirname(python))):
        raise
    os.execv(python, [python, *sys.argv])


class Span:
    """The smallest, largest, first and last of some values."""

    def __init__(self):
        self.first = self.last = self.least = self.most = None

    def add(self, value):
        if self.first is None:
            self.first = self.least = self.most = value
        self.last = value
        self.least = min(self.least, value)
        self.most = max(self.most, value)

    def report(self):
        return {"first": self.first, "last": self.last, "min": self.least, "max": self.most}


class Listener:
    """Counts and checks messages."""

    def __init__(self, table):
        self.table = table
        self.counts = {}
        self.bad_data = 0
        self.lost = 0
        self.sequences = {}
        self.senders = set()
        self.roll, self.pitch, self.yaw = Span(), Span(), Span()
        self.rates = [Span(), Span(), Span()]
        self.stamps = []
        self.times = []
        self.heartbeats = []
        self.texts = []
        self.text_stamps = []
        self.values = {}
        self.versions = set()

    def hear(self, message, now):
        kind = message.get_type()
        if kind == "BAD_DATA":
            self.bad_data += 1
            return
        self.counts[kind] = self.counts.get(kind, 0) + 1
        sender = (message.get_srcSystem(), message.get_srcComponent())
        self.senders.add(sender)
        self.versions.add(message.get_msgbuf()[0])
        sequence = message.get_seq()
        if sender in self.sequences:
            self.lost += (sequence - self.sequences[sender] - 1) % 256
        self.sequences[sender] = sequence
        if kind == "ATTITUDE":
            roll, pitch = math.degrees(message.roll), math.degrees(message.pitch)
            self.roll.add(roll)
            self.pitch.add(pitch)
            self.yaw.add(math.degrees(message.yaw))
            for span, rate in zip(self.rates, (message.rollspeed, message.pitchspeed, message.yawspeed)):
                span.add(math.degrees(rate))
            self.stamps.append(message.time_boot_ms)
            self.times.append(now)
            if self.table:
                self.table.writerow([message.time_boot_ms, f"{roll:.5f}", f"{pitch:.5f}", f"{now:.6f}"])
        elif kind == "HEARTBEAT":
            self.heartbeats.append(message)
            if message.system_status == mavutil.mavlink.MAV_STATE_POWEROFF:
                # Who comes after that counts anew.
                del self.sequences[sender]
        elif kind == "STATUSTEXT":
            self.texts.append({"severity": message.severity, "text": message.text})
            self.text_stamps.append(self.stamps[-1] if self.stamps else None)
        elif kind == "NAMED_VALUE_FLOAT":
            self.values.setdefault(message.name, Span()).add(message.value)

    def report(self, seconds):
        times, stamps = self.times, self.stamps
        span = times[-1] - times[0] if len(times) > 1 else 0.0
        steps = [(b - a) % 2**32 for a, b in zip(stamps, stamps[1:])]
        beats = self.heartbeats
        last = beats[-1] if beats else None
        return {
            "seconds": seconds,
            "counts": self.counts,
            "bad_data": self.bad_data,
            "lost": self.lost,
            "magic": sorted(self.versions),
            "senders": sorted(self.senders),
            "attitude": {
                "count": len(times),
                "rate_hz": (len(times) - 1) / span if span > 0 else 0.0,
                "longest_gap_s": max((b - a for a, b in zip(times, times[1:])), default=None),
                "roll_deg": self.roll.report(),
                "pitch_deg": self.pitch.report(),
                "yaw_deg": self.yaw.report(),
                "rates_deg_s": [span.report() for span in self.rates],
                "time_boot_ms": {"first": stamps[0], "last": stamps[-1]} if stamps else None,
                "time_boot_ms_monotonic": all(step < 2**31 for step in steps),
                "time_boot_ms_repeats": steps.count(0),
            },
            "heartbeat": {
                "count": len(beats),
                "type": last.type if last else None,
                "autopilot": last.autopilot if last else None,
                "base_mode": last.base_mode if last else None,
                "mavlink_version": last.mavlink_version if last else None,
                "system_status": [b.system_status for b in beats],
            },
            "statustext": self.texts,
            # Of the attitude before each.
            "statustext_time_boot_ms": self.text_stamps,
            "values": {name: span.report() for name, span in self.values.items()},
        }


def listen(args):
    if args.connect:
        link = mavutil.mavlink_connection(f"udpout:{args.connect}", source_system=255, robust_parsing=True)
    else:
        link = mavutil.mavlink_connection(f"udpin:{args.listen}", source_system=255, robust_parsing=True)
    table = file = None
    if args.csv:
        file = open(args.csv, "w", newline="", encoding="utf-8")
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["time_boot_ms", "roll_deg", "pitch_deg", "receive_time"])
    listener = Listener(table)
    ended = []
    signal.signal(signal.SIGTERM, lambda *_: ended.append(True))
    # Whoever waits for this program to listen reads this line.
    print(f"listening on {args.connect or args.listen}", file=sys.stderr, flush=True)
    begun, first, greeted = time.monotonic(), None, -1.0
    while True:
        now = time.monotonic()
        if args.connect and now - greeted > 1.0:
            greeted = now
            link.mav.heartbeat_send(mavutil.mavlink.MAV_TYPE_GCS, mavutil.mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        if ended or now - (first or begun) >= (args.seconds if first else args.wait):
            break
        message = link.recv_match(blocking=True, timeout=0.1)
        if message is None:
            continue
        first = first or time.monotonic()
        listener.hear(message, time.time())
    if file:
        file.close()
    return listener.report(time.monotonic() - (first or begun))


def plain(report):
    attitude, heartbeat = report["attitude"], report["heartbeat"]
    counts = ", ".join(f"{n} {kind}" for kind, n in sorted(report["counts"].items())) or "nothing"
    print(f"{counts} in {report['seconds']:.1f} s; {report['bad_data']} bad, {report['lost']} lost")
    if attitude["count"]:
        roll, pitch = attitude["roll_deg"], attitude["pitch_deg"]
        print(f"ATTITUDE at {attitude['rate_hz']:.2f} Hz: roll {roll['min']:.2f} to {roll['max']:.2f} deg, ", end="")
        print(f"pitch {pitch['min']:.2f} to {pitch['max']:.2f} deg")
    if heartbeat["count"]:
        print(f"HEARTBEAT: type {heartbeat['type']}, system_status {heartbeat['system_status']}")
    for text in report["statustext"]:
        print(f"STATUSTEXT {text['severity']}: {text['text']}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--listen", metavar="HOST:PORT", help="bind there, for a udpout endpoint")
    where.add_argument("--connect", metavar="HOST:PORT", help="send heartbeats there, for a udpin endpoint")
    parser.add_argument("--seconds", type=float, default=5.0, help="how long to listen, from the first message")
    parser.add_argument("--wait", type=float, default=30.0, help="how long to wait for the first message, s")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--csv", metavar="FILE", help="write each ATTITUDE there")
    args = parser.parse_args()
    report = listen(args)
    if args.json:
        print(json.dumps(report))
    else:
        plain(report)
    return 0 if report["counts"] else 1


if __name__ == "__main__":
    sys.exit(main())
