# Answers what it received with its digest.
import hashlib
import socket

listener = socket.create_server(("", 7000))
while True:
    connection, _ = listener.accept()
    digest = hashlib.sha256()
    while data := connection.recv(65536):
        digest.update(data)
    connection.sendall(digest.hexdigest().encode())
    connection.close()
