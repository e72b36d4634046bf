#!/usr/bin/env python3
"""What Wireshark's tshark makes of the feed, with the dissector that pymavlink generates."""

import json
import math
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time
from importlib.resources import files

import samples

RAW_IP = 101  # the link type of a capture that begins with the IP header
PORT = 14550  # where the dissector looks


def questions(system, component=191):
    """Messages that make the component send each kind that it does not send by itself."""
    os.environ["MAVLINK20"] = "1"
    from pymavlink.dialects.v20 import common as mavlink

    def packed(sender, message):
        return bytes(message.pack(sender))

    station, autopilot = mavlink.MAVLink(None, 250, 190), mavlink.MAVLink(None, system, 1)
    command = lambda *words: packed(
        station, station.command_long_encode(system, component, words[0], 0, *[*words[1:], *[0] * 7][:7])
    )
    for number in (mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION_COV):
        yield command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number, 200_000)
    yield command(mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, mavlink.MAVLINK_MSG_ID_ATTITUDE)
    yield command(mavlink.MAV_CMD_REQUEST_MESSAGE, mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION)
    yield command(mavlink.MAV_CMD_DO_SET_SERVO, 1, 1500)
    yield packed(station, station.param_request_list_encode(system, component))
    yield packed(station, station.param_request_read_encode(system, component, b"NO_SUCH", -1))
    yield packed(station, station.timesync_encode(0, 1))
    # An autopilot that sends nothing more is asked to.
    beat = (mavlink.MAV_TYPE_FIXED_WING, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, 0, 0, mavlink.MAV_STATE_ACTIVE)
    for _ in range(5):
        yield packed(autopilot, autopilot.heartbeat_encode(*beat))


def capture(args):
    """Datagrams that arrive. Their sender is asked two questions a second, if it is to be."""
    datagrams, heard = [], samples.Samples(args)
    asks, asked = questions(args.system) if args.ask else iter(()), 0.0
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as link:
        link.bind((args.host, args.port))
        link.settimeout(0.1)
        samples.listening()
        while not heard.done():
            try:
                datagram, sender = link.recvfrom(4096)
            except TimeoutError:
                continue
            datagrams.append(datagram)
            # The seconds are counted from the first message, whichever it is.
            heard.add(0, 0, 0)
            if time.monotonic() - asked > 0.5 and (question := next(asks, None)):
                asked = time.monotonic()
                link.sendto(question, sender)
    return datagrams


def write_capture(path, datagrams):
    """A capture file of these datagrams, as if from one port of this machine to another."""
    with open(path, "wb") as file:
        file.write(struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, RAW_IP))
        for i, datagram in enumerate(datagrams):
            udp = struct.pack(">HHHH", 40000, PORT, 8 + len(datagram), 0)
            ends = socket.inet_aton("127.0.0.1") * 2
            header = struct.pack(">BBHHHBBH8s", 0x45, 0, 28 + len(datagram), i & 0xFFFF, 0, 64, 17, 0, ends)
            packet = header + udp + datagram
            file.write(struct.pack("<IIII", i // 1000, i % 1000 * 1000, len(packet), len(packet)) + packet)


def dissector(folder):
    """pymavlink's Lua dissector of the common dialect, generated."""
    os.environ["MAVLINK20"] = "1"
    from pymavlink.generator import mavgen, mavparse

    path = os.path.join(folder, "mavlink.lua")
    options = mavgen.Opts(path, wire_protocol=mavparse.PROTOCOL_2_0, language="WLua", validate=False)
    definition = str(files("pymavlink") / "dialects" / "v20" / "common.xml")
    # It prints what it does.
    out, sys.stdout = sys.stdout, sys.stderr
    try:
        mavgen.mavgen(options, [definition])
    finally:
        sys.stdout = out
    return path


def main():
    args = samples.arguments(__doc__)
    datagrams = capture(args)
    if not datagrams:
        print(json.dumps({"attitude": []}))
        return 1
    with tempfile.TemporaryDirectory(prefix="irhorizon-tshark-") as folder:
        path = os.path.join(folder, "feed.pcap")
        write_capture(path, datagrams)
        command = ["tshark", "-r", path, "-X", f"lua_script:{dissector(folder)}", "-T", "json", "--no-duplicate-keys"]
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "HOME": folder})
        if done.returncode != 0:
            sys.exit(f"tshark: {done.stderr}")
        packets = json.loads(done.stdout)
    report(datagrams, packets, done.stderr)
    return 0


def report(datagrams, packets, said):
    """One packet each: its layers must have been understood to the end."""
    attitude, counts, errors = [], {}, []
    for datagram, packet in zip(datagrams, packets, strict=True):
        layers = packet["_source"]["layers"]
        message = layers.get("mavlink_proto")
        number = int.from_bytes(datagram[7:10], "little")
        counts[number] = counts.get(number, 0) + 1
        text = json.dumps(layers)
        known = message is not None and "mavlink_proto.payload_tree" in message and "mavlink_proto.crc" in message
        if not known or "_ws.malformed" in text or "_ws.expert" in text:
            errors.append(layers)
        elif number == 30:
            fields = {name.rpartition(".ATTITUDE_")[2]: value for name, value in flat(message).items()}
            names = ("roll", "pitch", "rollspeed", "pitchspeed", "yawspeed")
            angles = (math.degrees(float(fields[name])) for name in names)
            attitude.append((int(fields["time_boot_ms"]), *angles))
    if "Lua:" in said:
        errors.append(said)
    version = subprocess.run(["tshark", "--version"], capture_output=True, text=True).stdout.split("\n")[0]
    print(json.dumps({"attitude": attitude, "counts": counts, "errors": errors[:3], "version": version, "said": said}))


def flat(layer):
    """All fields of a layer, however deep, by name."""
    fields = {}
    for name, value in layer.items():
        if isinstance(value, dict):
            fields.update(flat(value))
        else:
            fields[name] = value
    return fields


if __name__ == "__main__":
    sys.exit(main())
