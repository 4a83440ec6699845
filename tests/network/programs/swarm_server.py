# Takes a connection of each robot and answers how many lines it sent.
import socket
import threading

listener = socket.create_server(("", 7000))


def serve(connection):
    lines = 0
    for line in connection.makefile("rb"):
        print(line.decode().strip(), flush=True)
        lines += 1
    connection.sendall(b"%d" % lines)
    connection.close()


while True:
    taken, _ = listener.accept()
    threading.Thread(target=serve, args=(taken,), daemon=True).start()
