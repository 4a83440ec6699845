# Half a megabyte there, and whether it came as it was; how long it took.
import hashlib
import socket
import time

time.sleep(0.2)
data = bytes((i * 7 + (i >> 8)) & 255 for i in range(500_000))
server = socket.create_connection(("server", 7000))
begin = time.monotonic()
server.sendall(data)
server.shutdown(socket.SHUT_WR)
answer = b""
while part := server.recv(100):
    answer += part
print("same", answer.decode() == hashlib.sha256(data).hexdigest(), time.monotonic() - begin, flush=True)
