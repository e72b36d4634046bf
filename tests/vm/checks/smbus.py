"""SMBus through /dev/i2c-N, by the kernel's ioctls and nothing else."""

import ctypes
import errno
import fcntl
import os
import struct

I2C_SLAVE, I2C_FUNCS, I2C_RDWR, I2C_PEC, I2C_SMBUS = 0x0703, 0x0705, 0x0707, 0x0708, 0x0720
FUNC_I2C, FUNC_PEC = 0x1, 0x8
READ, WRITE, WORD_DATA = 1, 0, 3
MSG_READ = 1


class SmbusArguments(ctypes.Structure):
    _fields_ = [
        ("direction", ctypes.c_uint8),
        ("command", ctypes.c_uint8),
        ("size", ctypes.c_uint32),
        ("data", ctypes.c_void_p),
    ]


class Message(ctypes.Structure):
    _fields_ = [
        ("addr", ctypes.c_uint16),
        ("flags", ctypes.c_uint16),
        ("len", ctypes.c_uint16),
        ("buf", ctypes.c_void_p),
    ]


class Messages(ctypes.Structure):
    _fields_ = [("msgs", ctypes.POINTER(Message)), ("count", ctypes.c_uint32)]


class Chip:
    """One address on one bus, on a file descriptor of its own."""

    def __init__(self, bus, addr, pec=False):
        self.addr = addr
        self.fd = os.open(f"/dev/i2c-{bus}", os.O_RDWR)
        try:
            fcntl.ioctl(self.fd, I2C_SLAVE, addr)
            fcntl.ioctl(self.fd, I2C_PEC, int(pec))
        except OSError:
            self.close()
            raise

    def close(self):
        os.close(self.fd)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def functions(self):
        reply = bytearray(8)
        fcntl.ioctl(self.fd, I2C_FUNCS, reply)
        return struct.unpack("@Q", reply)[0]

    def _word(self, direction, command, data):
        # Room for a union i2c_smbus_data, of which a word is the start.
        buffer = ctypes.create_string_buffer(struct.pack("<H", data), 34)
        arguments = SmbusArguments(direction, command, WORD_DATA, ctypes.addressof(buffer))
        fcntl.ioctl(self.fd, I2C_SMBUS, arguments)
        return struct.unpack("<H", buffer[:2])[0]

    def read(self, command):
        return self._word(READ, command, 0)

    def write(self, command, word):
        self._word(WRITE, command, word)

    def transfer(self, written, read_len=0):
        """A combined transfer: write bytes, then, if wanted, read some."""
        out = ctypes.create_string_buffer(bytes(written), len(written))
        back = ctypes.create_string_buffer(max(read_len, 1))
        msgs = (Message * 2)(
            Message(self.addr, 0, len(written), ctypes.addressof(out)),
            Message(self.addr, MSG_READ, read_len, ctypes.addressof(back)),
        )
        fcntl.ioctl(self.fd, I2C_RDWR, Messages(msgs, 2 if read_len else 1))
        return back.raw[:read_len]


def error_of(action):
    """The errno name that an action fails with, or "none"."""
    try:
        action()
    except OSError as error:
        # One number has two names on Linux, and Python picks the other.
        return "EOPNOTSUPP" if error.errno == errno.EOPNOTSUPP else errno.errorcode[error.errno]
    return "none"


def bus_of(name):
    """The number of the adapter whose name begins so."""
    for entry in os.listdir("/sys/bus/i2c/devices"):
        if entry.startswith("i2c-"):
            with open(f"/sys/bus/i2c/devices/{entry}/name") as file:
                if file.read().lower().startswith(name):
                    return int(entry[4:])
    raise LookupError(f"no I2C adapter is called {name}")
