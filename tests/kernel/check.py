#!/usr/bin/env python3
"""Compares what pymavlink heard outside the guest with the truth that the tests inside wrote down.

check.py FOLDER NAME…    <name>.truth.csv, <name>.heard.csv and <name>.json of each are there

The expectation is the report's scheme (section IV.B) restated, from the raw values that the sensors
showed: roll = asin(y/R), pitch = asin(x/R), R the vertical pair's output low-passed, roll limited. Prints as Rust's tests do. Exit status 0 when all passed.
"""

import bisect
import csv
import json
import math
import os
import sys

TOLERANCE_DEG = 0.5
# A pose counts from this long after it was taken up: what was being converted then is out by now.
SETTLE_MS = 400.0

# From raw values to the pairs' signals in kelvin (x, y, z): x = tail - nose, y = right - left,
# z = down - up at 0.02 K a bit; or each pair's volts with its neutral and its gain.
PAIRS = {
    "mlx": lambda r: [0.02 * (r["tail"] - r["nose"]), 0.02 * (r["right"] - r["left"]), 0.02 * (r["down"] - r["up"])],
    "polled": lambda r: [40.0 * r["long_v"], -40.0 * (r["lat_v"] - 0.01), 50.0 * (r["vert_v"] + 0.02)],
    "multiplexed": lambda r: [40.0 * (r["long_v"] - 1.65), 40.0 * (r["lat_v"] - 1.65), -40.0 * (r["vert_v"] - 1.65)],
}


class Truth:
    """What the sensors showed, and when."""

    def __init__(self, path, pairs):
        with open(path, newline="", encoding="utf-8") as file:
            facts = dict(fact.split("=") for fact in file.readline().split()[1:])
            rows = list(csv.DictReader(file))
        self.rate_hz, self.limit = float(facts["rate_hz"]), float(facts["roll_limit_deg"])
        self.time_constant_s = float(facts["time_constant_s"])
        self.times = [float(row["boot_ms"]) for row in rows]
        self.poses = [row.pop("pose") for row in rows]
        self.signals = [pairs({name: float(value) for name, value in row.items()}) for row in rows]

    def at(self, ms):
        """The number of the step that holds then."""
        return max(bisect.bisect_right(self.times, ms) - 1, 0)

    def expectations(self, stamps):
        """Roll, pitch and the pose held at each of these times: frame by frame, as R is filtered."""
        spread, last = abs(self.signals[0][2]), self.times[0]
        for stamp in stamps:
            step = self.at(stamp)
            x, y, z = self.signals[step]
            spread += (abs(z) - spread) * -math.expm1(-(stamp - last) / 1e3 / self.time_constant_s)
            last = stamp
            roll, pitch = (math.degrees(math.asin(max(-1.0, min(1.0, v / spread)))) for v in (y, x))
            settled = stamp >= self.times[step] + SETTLE_MS
            yield max(-self.limit, min(self.limit, roll)), pitch, self.poses[step] if settled else ""


def check(folder, name):
    """The errors found."""
    truth = Truth(os.path.join(folder, f"{name}.truth.csv"), PAIRS[name])
    with open(os.path.join(folder, f"{name}.json"), encoding="utf-8") as file:
        report = json.load(file)
    with open(os.path.join(folder, f"{name}.heard.csv"), newline="", encoding="utf-8") as file:
        heard = [(int(row["time_boot_ms"]), float(row["roll_deg"]), float(row["pitch_deg"])) for row in csv.DictReader(file)]
    errors = []

    def require(holds, text):
        if not holds:
            errors.append(text)

    require(report["bad_data"] == 0, f"{report['bad_data']} bad data")
    require(report["lost"] == 0, f"{report['lost']} messages lost")
    require(report["senders"] == [[1, 191]], f"senders {report['senders']}")
    # What was flown before was flown again: the machine stood still.
    texts = zip(report["statustext"], report["statustext_time_boot_ms"])
    texts = [text for text, stamp in texts if stamp is None or stamp >= truth.times[0]]
    require(not texts, f"STATUSTEXT {texts}")
    stamps = [stamp for stamp, _, _ in heard]
    require(all(a < b for a, b in zip(stamps, stamps[1:])), "time_boot_ms does not rise strictly")

    flight = [stamp for stamp in stamps if truth.times[0] < stamp < truth.times[-1]]
    rate_hz = (len(flight) - 1) / (flight[-1] - flight[0]) * 1e3 if len(flight) > 1 else 0.0
    require(abs(rate_hz / truth.rate_hz - 1.0) <= 0.05, f"{rate_hz:.2f} Hz instead of {truth.rate_hz}")

    worst, moving, counts = {}, 0.0, {pose: 0 for pose in truth.poses if pose}
    for (stamp, roll, pitch), (want_roll, want_pitch, pose) in zip(heard, truth.expectations(stamps)):
        error = max(abs(roll - want_roll), abs(pitch - want_pitch))
        if not pose:
            moving = max(moving, error if stamp > truth.times[0] else 0.0)
            continue
        counts[pose] += 1
        worst[pose] = max(worst.get(pose, 0.0), error)
        require(
            error <= TOLERANCE_DEG,
            f"{pose} at {stamp} ms: roll {roll:.2f}, pitch {pitch:.2f} instead of {want_roll:.2f}, {want_pitch:.2f}",
        )
    require(len(counts) == 9, f"{len(counts)} poses")
    require(all(count >= truth.rate_hz for count in counts.values()), f"less than a second of a pose: {counts}")
    gap = max((b - a for a, b in zip(flight, flight[1:])), default=0)
    print(f"{name}: worst error by MAVLink {max(worst.values(), default=math.nan):.3f}° in poses, {moving:.2f}° moving; ", end="")
    print(f"{rate_hz:.3f} Hz, longest gap {gap} ms, {len(heard)} ATTITUDE")
    return errors


def main():
    folder, names = sys.argv[1], sys.argv[2:]
    print(f"\nrunning {len(names)} tests")
    failed = 0
    for name in names:
        try:
            errors = check(folder, name)
        except (OSError, ValueError, KeyError, IndexError) as error:
            errors = [f"{type(error).__name__}: {error}"]
        print(f"test mavlink::{name} ... {'FAILED' if errors else 'ok'}")
        for error in errors[:10]:
            print(f"    {error}")
        failed += bool(errors)
    verdict = "FAILED" if failed else "ok"
    print(f"\ntest result: {verdict}. {len(names) - failed} passed; {failed} failed; 0 ignored; 0 measured; 0 filtered out")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
