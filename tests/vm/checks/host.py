"""Ways between the guest and the host: the shared folder, UDP, the files."""

import os
import socket

from report import check


def ways(port):
    share = os.environ["IRHORIZON_SHARE"]
    with open(f"{share}/from-host") as file:
        check("the shared folder reads", file.read(), "host")
    with open(f"{share}/from-guest", "w") as file:
        file.write("guest")
    check("the tests are asked for", os.environ.get("IRHORIZON_KERNEL_TESTS"), "1")
    # Whether it arrives, the host tells at the end.
    host = os.environ["IRHORIZON_HOST"]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        for _ in range(5):
            sender.sendto(b"from the guest", (host, int(port)))
    path = f"/tmp/selftest-{os.getpid()}"
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(path)
    os.remove(path)
    check("/tmp takes sockets and files", os.path.exists(path), False)
