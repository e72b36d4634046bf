"""What the clients have in common: their arguments, and the report of the attitudes they show."""

import argparse
import json
import sys
import time


def arguments(doc):
    """--listen HOST:PORT (for a udpout endpoint), --seconds to listen from the first attitude, --wait for it."""
    parser = argparse.ArgumentParser(description=doc)
    parser.add_argument("--listen", metavar="HOST:PORT", required=True)
    parser.add_argument("--seconds", type=float, default=5.0)
    parser.add_argument("--wait", type=float, default=30.0)
    parser.add_argument("--system", type=int, default=1, help="the daemon's system id")
    parser.add_argument("--ask", action="store_true", help="make it send what it sends when asked (dissect.py)")
    args = parser.parse_args()
    host, port = args.listen.rsplit(":", 1)
    args.host, args.port = host, int(port)
    return args


def listening():
    """Whoever waits for a client to listen reads this line."""
    print("listening", file=sys.stderr, flush=True)


class Samples:
    """Attitudes as a client shows them: time_boot_ms, roll and pitch in degrees, body rates in degrees a second, if they
    are shown beside them, and when."""

    def __init__(self, args):
        self.seconds, self.wait = args.seconds, args.wait
        self.begun = time.monotonic()
        self.rows = []

    def add(self, *shown):
        self.rows.append((*shown, time.monotonic()))

    def done(self):
        """Whether it has listened for long enough, or waited in vain."""
        begun, limit = (self.rows[0][-1], self.seconds) if self.rows else (self.begun, self.wait)
        return time.monotonic() - begun >= limit

    def report(self, **more):
        """Prints all as JSON; the exit status."""
        print(json.dumps({"attitude": [row[:-1] for row in self.rows], **more}))
        return 0 if self.rows else 1
