"""i2c-stub and i2c-fault: memory, PEC, and each fault as a program sees it."""

import os
import subprocess
import time

from report import check
from smbus import FUNC_I2C, FUNC_PEC, Chip, bus_of, error_of

PARAMETERS = "/sys/module/i2c_fault/parameters"


def sh(*command):
    subprocess.run(command, check=True)


def fault(name, value):
    with open(f"{PARAMETERS}/{name}", "w") as file:
        file.write(str(value))


def get(name):
    with open(f"{PARAMETERS}/{name}") as file:
        return file.read().strip()


def crc8(data):
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x07) & 0xFF if crc & 0x80 else crc << 1
    return crc


def stub():
    sh("modprobe", "i2c-stub", "chip_addr=0x5a,0x48")
    bus = bus_of("smbus stub")
    with Chip(bus, 0x5A) as chip, Chip(bus, 0x5A) as other:
        chip.write(0x07, 0x3AD2)
        check("i2c-stub keeps a word", chip.read(0x07), 0x3AD2)
        other.write(0x07, 0x1234)
        check("i2c-stub: another program moves it", chip.read(0x07), 0x1234)
        check("i2c-stub has no PEC", chip.functions() & FUNC_PEC, 0)
        check("i2c-stub refuses a combined transfer", error_of(lambda: chip.transfer([7], 2)), "EOPNOTSUPP")
    with Chip(bus, 0x10) as chip:
        check("i2c-stub: an absent chip", error_of(lambda: chip.read(0)), "ENODEV")


def words():
    sh("modprobe", "i2c-fault", "chip_addr=0x5a,0x5b,0x48", "nr=9")
    check("i2c-fault is the bus asked for", bus_of("i2c-fault"), 9)
    with Chip(9, 0x5A) as plain, Chip(9, 0x5A, pec=True) as chip, Chip(9, 0x5B) as other:
        check("i2c-fault has I2C and PEC", chip.functions() & (FUNC_I2C | FUNC_PEC), FUNC_I2C | FUNC_PEC)
        chip.write(0x07, 0x3AD2)
        check("a word with PEC comes back", chip.read(0x07), 0x3AD2)
        check("and without PEC", plain.read(0x07), 0x3AD2)
        check("the next chip has its own", other.read(0x07), 0)
        # The read of the datasheet, at 0x5a: B4 07 B5 D2 3A, PEC 30.
        check("a combined read, low byte first, PEC of the datasheet",
              chip.transfer([0x07], 3), bytes([0xD2, 0x3A, 0x30]))
        frame = [0x07, 0xDF, 0x3A]
        chip.transfer(frame + [crc8([0xB4, *frame])])
        check("a write whose PEC is right takes", chip.read(0x07), 0x3ADF)
        frame = [0x07, 0x01, 0x02]
        wrong = [*frame, crc8([0xB4, *frame]) ^ 1]
        check("a write whose PEC is wrong is refused", error_of(lambda: chip.transfer(wrong)), "ENXIO")
        check("and changes nothing", chip.read(0x07), 0x3ADF)
        before = int(get("transfers"))
        chip.read(0x07)
        check("transfers are counted", int(get("transfers")), before + 1)


def faults():
    with Chip(9, 0x5A, pec=True) as chip, Chip(9, 0x5A) as plain, Chip(9, 0x5B, pec=True) as other:
        fault("bad_pec", 0x5A)
        check("a bad PEC on reads", error_of(lambda: chip.read(7)), "EBADMSG")
        check("is not seen without PEC", error_of(lambda: plain.read(7)), "none")
        check("nor at the next chip", error_of(lambda: other.read(7)), "none")
        fault("bad_pec", 0)
        check("the PEC is right again", error_of(lambda: chip.read(7)), "none")

        fault("nak", "0x5a,0x48")
        check("a chip that does not answer", error_of(lambda: chip.read(7)), "ENXIO")
        check("the next one does", error_of(lambda: other.read(7)), "none")
        fault("nak", 0)
        fault("nak", 0x5A)
        fault("every", 2)
        results = sorted(error_of(lambda: chip.read(7)) for _ in range(10))
        check("every=2 strikes each second time", results, ["ENXIO"] * 5 + ["none"] * 5)
        fault("every", 1)
        fault("nak", 0)
        with Chip(9, 0x20) as absent:
            check("an absent chip", error_of(lambda: absent.read(0)), "ENXIO")

        fault("held", 1)
        check("a held bus", error_of(lambda: chip.read(7)), "ETIMEDOUT")
        fault("held", 0)
        check("the bus let go", error_of(lambda: chip.read(7)), "none")

        fault("delay_us", 200000)
        start = time.monotonic()
        chip.read(7)
        check("a slow transfer takes its time", time.monotonic() - start >= 0.2)
        fault("delay_us", 0)

        fault("garbage", 0x5A)
        check("garbage varies", len({chip.read(7) for _ in range(8)}) > 4)
        fault("garbage", 0)
        check("and leaves the register alone", chip.read(7), 0x3ADF)


def eeprom():
    fault("eeprom", 1)
    with Chip(9, 0x5A, pec=True) as chip, Chip(9, 0x5A) as plain:

        def write(value):
            chip.write(0x24, value)
            time.sleep(0.01)

        write(0)
        write(0xFFFF)
        check("EEPROM: erase, then write", chip.read(0x24), 0xFFFF)
        write(0xE666)
        check("EEPROM: a write without erasing is lost", chip.read(0x24), 0xFFFF)
        write(0)
        check("EEPROM: erased", chip.read(0x24), 0)
        check("EEPROM: a write without PEC is refused", error_of(lambda: plain.write(0x24, 1)), "ENXIO")
        chip.write(0x25, 0)
        chip.write(0x25, 0x1234)
        time.sleep(0.01)
        check("EEPROM: a write too soon is lost", chip.read(0x25), 0)
        check("EEPROM: a chip knows its address", chip.read(0x2E), 0xBE5A)
    # The way a chip alone on its bus gets another address.
    with Chip(9, 0, pec=True) as anyone, Chip(9, 0x2C) as moved, Chip(9, 0x5A) as old:
        for value in (0, 0xBE2C):
            anyone.write(0x2E, value)
            time.sleep(0.01)
        check("EEPROM: the address waits for power", error_of(lambda: moved.read(7)), "ENXIO")
        fault("power_cycle", 1)
        check("after power the chip has moved", moved.read(7), 0x3ADF)
        check("and left its old address", error_of(lambda: old.read(7)), "ENXIO")
    fault("eeprom", 0)


def removal():
    chip = Chip(9, 0x5B)
    removing = subprocess.Popen(["rmmod", "i2c-fault"])
    time.sleep(1)
    check("rmmod waits for the open node", removing.poll(), None)
    check("the node is gone meanwhile", os.path.exists("/dev/i2c-9"), False)
    check("a transfer then fails", error_of(lambda: chip.read(7)), "ENODEV")
    chip.close()
    check("rmmod ends when the node is closed", removing.wait(timeout=20), 0)
    sh("modprobe", "i2c-fault", "chip_addr=0x5a,0x48", "nr=9")
    with Chip(9, 0x5A) as back:
        check("loaded again, the bus is back", back.read(7), 0)


def claimed(bus, driver, name, addr):
    """A kernel driver takes the chip: programs get EBUSY until it lets go."""
    where = f"/sys/bus/i2c/devices/i2c-{bus}"
    device = f"/sys/bus/i2c/devices/{bus}-{addr:04x}"
    sh("modprobe", driver)
    with open(f"{where}/new_device", "w") as file:
        file.write(f"{name} {addr:#x}")
    bound = os.path.basename(os.path.realpath(f"{device}/driver"))
    check(f"{driver} binds to {name} on bus {bus}", os.path.exists(f"{device}/driver"))
    check(f"a chip that {bound} has is busy", error_of(lambda: Chip(bus, addr)), "EBUSY")
    with open(f"{device}/driver/unbind", "w") as file:
        file.write(os.path.basename(device))
    check("unbound, it is free", error_of(lambda: Chip(bus, addr).close()), "none")
    with open(f"{where}/delete_device", "w") as file:
        file.write(f"{addr:#x}")


def all_claimed():
    claimed(9, "mlx90614", "mlx90614", 0x5A)
    claimed(bus_of("smbus stub"), "mlx90614", "mlx90614", 0x5A)
    claimed(9, "ti-ads1015", "ads1115", 0x48)


def unload():
    sh("rmmod", "i2c-fault")
    sh("rmmod", "i2c-stub")
    check("both adapters unload", os.path.exists("/dev/i2c-9"), False)


SECTIONS = (stub, words, faults, eeprom, removal, all_claimed, unload)
