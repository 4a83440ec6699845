# Takes one connection, and prints how many octets came and how it ended.
import socket

connection, _ = socket.create_server(("", 7000)).accept()
count = 0
try:
    while data := connection.recv(65536):
        count += len(data)
    print(count, "end", flush=True)
except OSError as error:
    print(count, type(error).__name__, flush=True)
