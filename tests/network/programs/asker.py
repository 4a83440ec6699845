# Asks robots by number what their firmware answers, beside the manager's other clients.
import socket
import time

time.sleep(3.0)
manager = socket.create_connection(("manager", 7700))
manager.sendall(b"1 ?one\r2 ?two\r7 ?nobody\r")
manager.settimeout(1.0)
heard = b""
until = time.monotonic() + 1.0
while time.monotonic() < until and heard.count(b"!") < 2:
    heard += manager.recv(1000)
for line in sorted(line for line in heard.decode().split("\r") if "!" in line):
    print(line, flush=True)
