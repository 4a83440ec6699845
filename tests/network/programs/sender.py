# A robot's client of the network manager that sends the time ten times a second, and prints what it hears when.
import select
import socket
import sys
import time

number, other = int(sys.argv[1]), int(sys.argv[2])
begin = time.monotonic()
now = lambda: time.monotonic() - begin
time.sleep(0.1)
manager = socket.create_connection(("manager", 7700))
manager.sendall(b"-1 @%d,0 here\r" % number)
heard = b""
for i in range(45):
    due = 0.55 + 0.1 * i
    while (left := due - now()) > 0:
        if not select.select([manager], [], [], left)[0]:
            continue
        heard += manager.recv(1000)
        *lines, heard = heard.split(b"\r")
        for line in lines:
            if not line.endswith(b"here"):
                print(f"{line.decode()} came at {now():.3f}", flush=True)
    if i < 44:
        manager.sendall(b"%d sent at %.3f\r" % (other, now()))
