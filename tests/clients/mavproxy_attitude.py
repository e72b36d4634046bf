#!/usr/bin/env python3
"""Attitude as a MAVProxy without windows shows it, with `watch ATTITUDE`."""

import math
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
from importlib.metadata import version

import samples

SHOWN = re.compile(r"< ATTITUDE \{time_boot_ms : (\d+), roll : (\S+), pitch : (\S+), yaw : \S+, "
                   r"rollspeed : (\S+), pitchspeed : (\S+), yawspeed : (\S+)\}")


def main():
    args = samples.arguments(__doc__)
    heard = samples.Samples(args)
    folder = tempfile.TemporaryDirectory(prefix="irhorizon-mavproxy-")
    script = os.path.join(os.path.dirname(sys.executable), "mavproxy.py")
    # It takes the first system for its own; one without an autopilot wants to be told.
    options = [f"--master=udpin:{args.listen}", f"--target-system={args.system}", "--source-system=250"]
    options += ["--non-interactive", "--default-modules=", "--cmd=watch ATTITUDE", f"--state-basedir={folder.name}"]
    process = subprocess.Popen(
        [sys.executable, "-u", script, *options],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder.name,
        env={**os.environ, "HOME": folder.name},
    )
    # However long nothing is said, it ends.
    timer = threading.Timer(args.wait + args.seconds + 10, process.kill)
    timer.start()
    other, errors = [], []
    for line in process.stdout:
        shown = SHOWN.match(line)
        if shown:
            heard.add(int(shown[1]), *(math.degrees(float(angle)) for angle in shown.groups()[1:]))
        else:
            other.append(line.rstrip())
            if line.startswith("Waiting for heartbeat"):
                samples.listening()
        if heard.done():
            break
    process.send_signal(signal.SIGTERM)
    process.stdout.close()
    process.wait(10)
    timer.cancel()
    errors = [line for line in other if "error" in line.lower() or "Traceback" in line]
    return heard.report(version=version("MAVProxy"), said=other[:20], errors=errors)


if __name__ == "__main__":
    sys.exit(main())
