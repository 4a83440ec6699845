# Wakes the main board, calls all other robots by broadcast and the server by TCP.
import os
import select
import socket
import termios
import time
import tty

name = socket.gethostname()
print(name, socket.gethostbyname(name), flush=True)
time.sleep(0.1)
line = os.open("/dev/ttyS0", os.O_RDWR | os.O_NOCTTY)
tty.setraw(line)
settings = termios.tcgetattr(line)
settings[4] = settings[5] = termios.B115200
termios.tcsetattr(line, termios.TCSANOW, settings)
calls = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
calls.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
calls.bind(("", 5000))
server = socket.create_connection(("server", 7000), timeout=1)
os.write(line, b"\x01\0\0\0\0")
sensors = sent = 0
start = time.monotonic()
while time.monotonic() < start + 0.8:
    due = start + 0.1 * (sent + 1)
    wait = max(0, due - time.monotonic()) if sent < 5 else 0.05
    ready, _, _ = select.select([calls, line], [], [], wait)
    if calls in ready:
        data, sender = calls.recvfrom(100)
        if not data.startswith(name.encode()):
            print("heard", data.decode(), sender[0], flush=True)
    if line in ready:
        sensors += len(os.read(line, 100))
    if sent < 5 and time.monotonic() >= due:
        calls.sendto(b"%s call %d" % (name.encode(), sent), ("255.255.255.255", 5000))
        server.sendall(b"%s line %d\n" % (name.encode(), sent))
        sent += 1
server.shutdown(socket.SHUT_WR)
print("server answers", server.recv(10).decode(), flush=True)
print("sensors", sensors, flush=True)
