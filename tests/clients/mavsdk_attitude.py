#!/usr/bin/env python3
"""Attitude as MAVSDK shows it: its Telemetry plugin on a system that has no autopilot."""

import math
import sys
import time

from mavsdk import Configuration, Mavsdk, __version__
from mavsdk.plugins.telemetry.telemetry import Telemetry

import samples


def main():
    args = samples.arguments(__doc__)
    # Its lines of log go where a report is expected.
    mavsdk = Mavsdk(Configuration.create_manual(245, 190, True))
    mavsdk.add_any_connection(f"udpin://{args.listen}")
    samples.listening()
    heard = samples.Samples(args)
    # first_autopilot() would wait for a component 1 for ever.
    while not mavsdk.get_systems() and not heard.done():
        time.sleep(0.02)
    systems = mavsdk.get_systems()
    if not systems:
        return heard.report(version=__version__)
    system = systems[0]
    telemetry = Telemetry(system)
    rates = []

    def turns(r):
        rates.append([math.degrees(rate) for rate in (r.roll_rad_s, r.pitch_rad_s, r.yaw_rad_s)])

    telemetry.subscribe_attitude_angular_velocity_body(lambda r, _: turns(r))
    telemetry.subscribe_attitude_euler(lambda a, _: heard.add(a.timestamp_us // 1000, a.roll_deg, a.pitch_deg))
    while not heard.done():
        time.sleep(0.02)
    found = {"system": system.get_system_id(), "components": system.component_ids(), "autopilot": system.has_autopilot()}
    status = heard.report(version=__version__, rates=rates, **found)
    sys.stdout.flush()
    mavsdk.destroy()
    return status


if __name__ == "__main__":
    sys.exit(main())
