# Sends twenty datagrams, one each 100 ms, and prints which came back.
import socket
import time

place = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
place.settimeout(0.1)
time.sleep(0.5)
for i in range(20):
    due = time.monotonic() + 0.1
    place.sendto(b"answer %d" % i, ("server", 7000))
    try:
        print(place.recv(100).decode(), flush=True)
    except socket.timeout:
        pass
    time.sleep(max(0.0, due - time.monotonic()))
