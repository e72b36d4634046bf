"""The part of selftest that runs under the kernel with the buses."""

import sys

import gpio
import host
import i2c
from report import end, section

if __name__ == "__main__":
    i2c.sh("modprobe", "i2c-dev")
    for part in (*i2c.SECTIONS, *gpio.SECTIONS):
        section(part)
    section(host.ways, sys.argv[1])
    end()
