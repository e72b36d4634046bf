#!/usr/bin/env python3
"""What was heard of a board, and what it said on its console: is it right?

check.py HEARD.json CONSOLE
"""

import json
import re
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    heard = json.load(file)
with open(sys.argv[2], encoding="utf-8", errors="replace") as file:
    console = file.read()
attitude, resident = heard["attitude"], re.search(r"VmRSS: (\d+) kB", console)
roll = attitude["roll_deg"]
wrong = [
    what
    for what, right in {
        "the configuration was not accepted": "arm: the configuration is accepted" in console,
        "a module was not loaded": "arm: cannot load" not in console,
        "the daemon did not last": resident,
        "the daemon's end was not orderly": "arm: irhorizond ended with status 0" in console,
        "fewer than 100 ATTITUDE": attitude["count"] > 100,
        "bytes that are not MAVLink": heard["bad_data"] == 0,
        "not from system 1, component 191": heard["senders"] == [[1, 191]],
        "roll is not 20°": attitude["count"] and abs(roll["last"] - 20) < 3,
    }.items()
    if not right
]
print(f"    {heard['counts']}, {heard['lost']} lost")
if attitude["count"]:
    print(f"    ATTITUDE at {attitude['rate_hz']:.1f} Hz, roll {roll['last']:.1f}°, ", end="")
print(f"resident {resident[1] if resident else '?'} kB")
for what in wrong:
    print(f"    {what}")
sys.exit(bool(wrong))
