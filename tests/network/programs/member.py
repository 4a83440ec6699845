# A robot's client of the network manager: where it is, what it sends, what it hears within a second.
import socket
import sys
import time

place, words = sys.argv[1], sys.argv[2:]
time.sleep(0.1)
manager = socket.create_connection(("manager", 7700))
manager.sendall(b"-1 @%s here\r" % place.encode())
time.sleep(0.3)
for word in words:
    manager.sendall(word.encode() + b"\r")
manager.settimeout(0.5)
heard = b""
try:
    while data := manager.recv(1000):
        heard += data
except socket.timeout:
    pass
for line in heard.decode().split("\r")[:-1]:
    if not line.endswith(" here"):
        print(line, flush=True)
