#!/usr/bin/env python3
"""Asks a MAVLink component the standard questions, with pymavlink, and says what it answered.

ask.py --listen 127.0.0.1:14550 --system 42 --component 191 message-interval ATTITUDE 10
ask.py --connect 127.0.0.1:14550 --component 191 param-set IRH_ROLL_TRIM 1.5

With --key FILE (32 bytes) it signs what it sends, unless --unsigned, and hears only what is signed by that key.
Every question is sent again up to five times, half a second apart, as the MAVLink services want it. Prints JSON:
{"asked": ..., "answer": {...} or null}. Exit status 0 when there was an answer, whatever it says, 1 when there was none.
"""

import argparse
import json
import os
import sys
import time

os.environ["MAVLINK20"] = "1"
os.environ["MAVLINK_DIALECT"] = "common"
from pymavlink import mavutil
from pymavlink.dialects.v20 import common as mavlink

TRIES, PATIENCE_S = 5, 0.5


class Link:
    """A ground station that speaks to one component."""

    def __init__(self, url, system, component, to=None, station=(250, mavlink.MAV_COMP_ID_MISSIONPLANNER)):
        own_system, own_component = station
        self.connection = mavutil.mavlink_connection(
            url, source_system=own_system, source_component=own_component, robust_parsing=True
        )
        self.mav = self.connection.mav
        self.sender = (system, component)
        # Whom the questions are for: another one than is listened to, if its silence is what is wanted.
        self.system, self.component = to or self.sender
        self.own = station

    def sign(self, key, outgoing):
        """pymavlink's own signing; with `outgoing` of what is sent too."""
        self.connection.setup_signing(key, sign_outgoing=outgoing)

    def greet(self):
        """A heartbeat: a udpin endpoint sends to whoever was heard."""
        self.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)

    def meet(self, patience_s):
        """Waits for a heartbeat of the component; before it a listening socket does not know whom to ask."""
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            self.greet()
            if self.hear("HEARTBEAT", lambda m: True, 0.5):
                return True
        return False

    def hear(self, kind, wanted, patience_s):
        """The next message of a kind from the component that is `wanted`; None when there is none in time."""
        end = time.monotonic() + patience_s
        while (left := end - time.monotonic()) > 0:
            message = self.connection.recv_match(type=kind, blocking=True, timeout=left)
            if message is None:
                continue
            sender = (message.get_srcSystem(), message.get_srcComponent())
            if sender == self.sender and wanted(message):
                return message.to_dict()
        return None

    def ask(self, send, kind, wanted=lambda m: True):
        """Sends a question until there is an answer. A command that is in progress is waited for; how far it was in
        between is `steps` of the answer."""
        for _ in range(TRIES):
            send()
            answer = self.hear(kind, wanted, PATIENCE_S)
            if answer is None:
                continue
            steps = []
            while answer and answer.get("result") == mavlink.MAV_RESULT_IN_PROGRESS:
                steps.append(answer["progress"])
                answer = self.hear(kind, wanted, 60.0)
            return {**answer, "steps": steps} if answer and steps else answer
        return None

    def is_ack(self, command):
        """An acknowledgement of this command that is meant for this station."""
        return lambda m: m.command == command and m.target_system in (0, self.own[0])

    def command(self, command, *params):
        """COMMAND_LONG; its COMMAND_ACK."""
        params = [*params, *[0.0] * 7][:7]
        send = lambda: self.mav.command_long_send(self.system, self.component, command, 0, *params)
        return self.ask(send, "COMMAND_ACK", self.is_ack(command))

    def command_int(self, command, *params):
        """COMMAND_INT; its COMMAND_ACK."""
        p = [*params, *[0.0] * 7][:7]
        send = lambda: self.mav.command_int_send(
            self.system, self.component, 0, command, 0, 0, p[0], p[1], p[2], p[3], int(p[4]), int(p[5]), p[6]
        )
        return self.ask(send, "COMMAND_ACK", self.is_ack(command))


def number_of(name):
    """The id of a message by its name."""
    return getattr(mavlink, f"MAVLINK_MSG_ID_{name}")


def message_interval(link, name, hz):
    """SET_MESSAGE_INTERVAL: hz 0 asks for the default, a negative one for silence. ACCEPTED for what is streamed."""
    interval = 0 if hz == 0 else -1 if hz < 0 else 1e6 / hz
    return link.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number_of(name), interval)


def get_message_interval(link, name):
    """GET_MESSAGE_INTERVAL: answered by MESSAGE_INTERVAL, interval_us 0 for what is never sent."""
    wanted = lambda m: m.message_id == number_of(name)
    send = lambda: link.mav.command_long_send(
        link.system, link.component, mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, 0, number_of(name), 0, 0, 0, 0, 0, 0
    )
    return link.ask(send, "MESSAGE_INTERVAL", wanted)


def request_message(link, name):
    """REQUEST_MESSAGE: both the acknowledgement and the message, in whichever order they come."""
    got = {"COMMAND_ACK": None, name: None}
    for _ in range(TRIES):
        command = mavlink.MAV_CMD_REQUEST_MESSAGE
        link.mav.command_long_send(link.system, link.component, command, 0, number_of(name), 0, 0, 0, 0, 0, 0)
        end = time.monotonic() + PATIENCE_S
        while (left := end - time.monotonic()) > 0:
            is_ack = link.is_ack(command)
            found = link.hear(list(got), lambda m: m.get_type() == name or is_ack(m), left)
            if found:
                got[found["mavpackettype"]] = found
            refused = got["COMMAND_ACK"] and got["COMMAND_ACK"]["result"] != mavlink.MAV_RESULT_ACCEPTED
            if refused or all(got.values()):
                return got
    return got if any(got.values()) else None


def param_list(link):
    """PARAM_REQUEST_LIST: every PARAM_VALUE; those that were lost are asked for by their index."""
    found, count = {}, None
    link.mav.param_request_list_send(link.system, link.component)
    for _ in range(TRIES):
        while value := link.hear("PARAM_VALUE", lambda m: m.param_index != 65535, PATIENCE_S):
            found[value["param_index"]], count = value, value["param_count"]
            if len(found) == count:
                return [found[i] for i in sorted(found)]
        for index in set(range(count or 0)) - set(found):
            link.mav.param_request_read_send(link.system, link.component, b"", index)
        if count is None:
            link.mav.param_request_list_send(link.system, link.component)
    return [found[i] for i in sorted(found)] or None


def param_read(link, name):
    """PARAM_REQUEST_READ by name: its PARAM_VALUE."""
    send = lambda: link.mav.param_request_read_send(link.system, link.component, name.encode(), -1)
    return link.ask(send, "PARAM_VALUE", lambda m: m.param_id == name)


def param_set(link, name, value, kind=mavlink.MAV_PARAM_TYPE_REAL32):
    """PARAM_SET: answered by a PARAM_VALUE with the value that holds now, the old one if it was refused."""
    send = lambda: link.mav.param_set_send(link.system, link.component, name.encode(), value, kind)
    return link.ask(send, "PARAM_VALUE", lambda m: m.param_id == name)


def calibrate(link):
    """PREFLIGHT_CALIBRATION of the level (param5 = 2, board level): ACCEPTED, or DENIED while it cannot be."""
    return link.command(mavlink.MAV_CMD_PREFLIGHT_CALIBRATION, 0, 0, 0, 0, 2)


def unsupported(link):
    """A command that no horizon has: MAV_RESULT_UNSUPPORTED, not silence."""
    return link.command(mavlink.MAV_CMD_DO_SET_SERVO, 1, 1500)


def timesync(link):
    """TIMESYNC with tc1 = 0 (pymavlink can give it no target): answered with the same ts1 and the own time, ns."""
    ts1 = time.monotonic_ns()
    send = lambda: link.mav.timesync_send(0, ts1)
    return link.ask(send, "TIMESYNC", lambda m: m.ts1 == ts1 and m.tc1 > 0)


def replayed(link):
    """A command, the same bytes once more, and the command anew: what each was answered."""
    name = mavlink.MAV_CMD_GET_MESSAGE_INTERVAL
    command = link.mav.command_long_encode(link.system, link.component, name, 0, number_of("ATTITUDE"), 0, 0, 0, 0, 0, 0)
    captured = command.pack(link.mav)
    answers = []
    for send in (captured, captured, None):
        link.connection.write(send or command.pack(link.mav))
        answers.append(link.hear("COMMAND_ACK", link.is_ack(name), 4 * PATIENCE_S))
    return answers


QUESTIONS = {
    "message-interval": (message_interval, [str, float]),
    "get-message-interval": (get_message_interval, [str]),
    "request-message": (request_message, [str]),
    "param-list": (param_list, []),
    "param-read": (param_read, [str]),
    "param-set": (param_set, [str, float]),
    "calibrate": (calibrate, []),
    "unsupported": (unsupported, []),
    "timesync": (timesync, []),
    "replayed": (replayed, []),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--listen", metavar="HOST:PORT", help="bind there, for a udpout endpoint")
    where.add_argument("--connect", metavar="HOST:PORT", help="speak to a udpin endpoint")
    where.add_argument("--url", help="any connection that pymavlink knows: tcp:HOST:PORT, a serial port")
    parser.add_argument("--system", type=int, default=1)
    parser.add_argument("--component", type=int, default=191)
    parser.add_argument("--to", type=int, nargs=2, metavar=("SYSTEM", "COMPONENT"), help="ask that one instead")
    parser.add_argument("--station", type=int, default=250, metavar="SYSTEM", help="the system id of who asks")
    parser.add_argument("--wait", type=float, default=30.0, metavar="S", help="for the component's first heartbeat")
    parser.add_argument("--key", metavar="FILE", help="the signing key")
    parser.add_argument("--unsigned", action="store_true", help="check signatures, make none")
    parser.add_argument("question", choices=QUESTIONS)
    parser.add_argument("words", nargs="*")
    args = parser.parse_args()
    ask, kinds = QUESTIONS[args.question]
    if len(args.words) != len(kinds):
        parser.error(f"{args.question} takes {len(kinds)} words")
    url = args.url or (f"udpin:{args.listen}" if args.listen else f"udpout:{args.connect}")
    station = (args.station, mavlink.MAV_COMP_ID_MISSIONPLANNER)
    link = Link(url, args.system, args.component, args.to and tuple(args.to), station)
    if args.key:
        with open(args.key, "rb") as file:
            link.sign(file.read(), not args.unsigned)
    print("listening", file=sys.stderr, flush=True)
    met = link.meet(args.wait)
    answer = ask(link, *(kind(word) for kind, word in zip(kinds, args.words))) if met else None
    signing = link.mav.signing
    signed = {"good": signing.goodsig_count, "bad": signing.badsig_count}
    report = {"asked": [args.question, *args.words], "met": met, "answer": answer, "signed": signed}
    print(json.dumps(report, default=str))
    return 0 if answer else 1


if __name__ == "__main__":
    sys.exit(main())
