#!/usr/bin/env python3
"""Drives straight on and turns at obstacles. It waits for each of the robot's answers, however long that takes."""
import os
import struct
import termios
import time
import tty


def answer(port):
    data = b""
    while len(data) < 72:
        data += os.read(port, 72 - len(data))
    return struct.unpack_from("<8h", data, 8)


port = os.open("/dev/ttyS0", os.O_RDWR | os.O_NOCTTY)
tty.setraw(port)
settings = termios.tcgetattr(port)
settings[4] = settings[5] = termios.B115200
termios.tcsetattr(port, termios.TCSAFLUSH, settings)
os.write(port, bytes([1, 0, 0, 0, 0]))  # wake-up and configuration
proximity = answer(port)
while True:
    blocked = max(proximity[0], proximity[7]) > 300
    left, right = (-200, 200) if blocked else (400, 400)  # motor steps/s
    os.write(port, struct.pack("<hhHBBBBBB", left, right, 0, 0, 0, 0, 0, ord("N"), 0))
    proximity = answer(port)
    time.sleep(0.1)
