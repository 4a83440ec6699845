#!/usr/bin/env python3
"""Says hello to everybody once a second, and prints what it hears."""
import socket
import time

PORT = 5000
line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
line.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
line.bind(("", PORT))
line.settimeout(1.0)
name = socket.gethostname()
for number in range(5):
    line.sendto(f"hello {number} from {name}".encode(), ("255.255.255.255", PORT))
    until = time.monotonic() + 1.0
    while (left := until - time.monotonic()) > 0:
        line.settimeout(left)
        try:
            text, sender = line.recvfrom(1500)
        except TimeoutError:
            break
        print(f"{time.monotonic():.6f} {sender[0]} {text.decode()}", flush=True)
