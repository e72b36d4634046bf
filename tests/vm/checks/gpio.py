"""gpio-sim: a pull makes an edge, an output reads back."""

import fcntl
import os
import select
import struct
import subprocess

from report import check

RIG = "/sys/kernel/config/gpio-sim/selftest"
GET_LINEHANDLE, GET_LINEEVENT = 0xC16CB403, 0xC030B404
OUTPUT, RISING, BOTH_EDGES = 2, 1, 3


def write(path, text):
    with open(path, "w") as file:
        file.write(text)


def read(path):
    with open(path) as file:
        return file.read().strip()


def event_line(chip, line):
    request = bytearray(struct.pack("@III32si", line, 1, BOTH_EDGES, b"selftest", 0))
    fcntl.ioctl(chip, GET_LINEEVENT, request)
    return struct.unpack("@III32si", request)[4]


def output_line(chip, line, value):
    layout = "@64II64B32sIi"
    request = bytearray(
        struct.pack(layout, line, *[0] * 63, OUTPUT, value, *[0] * 63, b"selftest", 1, 0)
    )
    fcntl.ioctl(chip, GET_LINEHANDLE, request)
    return struct.unpack(layout, request)[-1]


def lines():
    subprocess.run(["modprobe", "gpio-sim"], check=True)
    os.makedirs(f"{RIG}/bank0/line4")
    write(f"{RIG}/bank0/num_lines", "8")
    write(f"{RIG}/bank0/line4/name", "data-ready")
    write(f"{RIG}/live", "1")
    name = read(f"{RIG}/bank0/chip_name")
    lines_of = f"/sys/devices/platform/{read(f'{RIG}/dev_name')}/{name}"
    chip = os.open(f"/dev/{name}", os.O_RDWR)

    ready = event_line(chip, 4)
    write(f"{lines_of}/sim_gpio4/pull", "pull-up")
    seen = select.select([ready], [], [], 5)[0]
    check("gpio-sim: a pull-up wakes a listener", bool(seen))
    if seen:
        _, kind = struct.unpack("@QI4x", os.read(ready, 16))
        check("gpio-sim: with a rising edge", kind, RISING)
    os.close(ready)

    lamp = output_line(chip, 5, 1)
    check("gpio-sim: an output reads back", read(f"{lines_of}/sim_gpio5/value"), "1")
    os.close(lamp)
    os.close(chip)

    write(f"{RIG}/live", "0")
    for path in (f"{RIG}/bank0/line4", f"{RIG}/bank0", RIG):
        os.rmdir(path)
    subprocess.run(["rmmod", "gpio-sim"], check=True)
    check("gpio-sim unloads", os.path.exists("/sys/module/gpio_sim"), False)


SECTIONS = (lines,)
