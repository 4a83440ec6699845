#!/usr/bin/env python3
"""Passes bytes between a robot's serial line and a TCP server, as plain forwarders do: one loop that reads the
line with VTIME = 1, so until it was silent for a tenth of a second, and only then looks at the server."""
import os
import socket
import sys
import termios
import time

TENTHS = 1  # the shortest VTIME
MOST = 255

host, port = sys.argv[sys.argv.index("--server") + 1].rsplit(":", 1)
line = os.open("/dev/ttyS0", os.O_RDWR | os.O_NOCTTY)
settings = termios.tcgetattr(line)
settings[0] = settings[1] = settings[3] = 0
settings[2] = termios.CS8 | termios.CREAD | termios.CLOCAL
settings[4] = settings[5] = termios.B115200
settings[6][termios.VMIN] = 0
settings[6][termios.VTIME] = TENTHS
termios.tcsetattr(line, termios.TCSANOW, settings)

while True:
    try:
        server = socket.create_connection((host, int(port)))
        break
    except OSError:
        time.sleep(1)
server.setblocking(False)
waiting = b""
while True:
    while data := os.read(line, MOST):
        waiting += data
    if waiting:
        server.sendall(waiting)
        waiting = b""
    try:
        back = server.recv(4096)
        if not back:
            sys.exit("the server has gone")
        os.write(line, back)
    except BlockingIOError:
        pass
