# Drives a robot from afar: its main board's records come through puckloop-forward.
import socket
import struct

listener = socket.create_server(("", 7700))
robot, who = listener.accept()
print("robot", who[0], flush=True)


def sensors():
    record = b""
    while len(record) < 72:
        record += robot.recv(72 - len(record))
    return struct.unpack_from("<8h", record, 8)


robot.sendall(b"\x01\0\0\0\0")
print("proximity", len(sensors()), flush=True)
for step in range(5):
    robot.sendall(struct.pack("<hhHBBBBBB", 400, 400, 0, 0, 0, 0, 0, ord("N"), 0))
    sensors()
print("driven", flush=True)
