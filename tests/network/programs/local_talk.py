# Two programs of one board by a socket with a name: a stream with half-close, datagrams, who is at the other end.
import os, socket, struct, sys, tempfile

with tempfile.TemporaryDirectory() as folder:
    stream, words = os.path.join(folder, "stream"), os.path.join(folder, "words")
    listener = socket.socket(socket.AF_UNIX)
    listener.bind(stream)
    listener.listen(1)
    inbox = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    inbox.bind(words)
    child = os.fork()
    if child == 0:
        client = socket.socket(socket.AF_UNIX)
        client.connect(stream)
        client.sendall(b"question " * 1000)
        client.shutdown(socket.SHUT_WR)
        answer = b"".join(iter(lambda: client.recv(4096), b""))
        out = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        out.sendto(b"heard %d" % len(answer), words)
        os._exit(0)
    server, _ = listener.accept()
    number, _, _ = struct.unpack("3i", server.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))
    asked = b"".join(iter(lambda: server.recv(4096), b""))
    server.sendall(asked.upper())
    server.close()
    print("asked", len(asked), "by the child", number == child)
    print("word", inbox.recv(100))
    print("ended", os.waitpid(child, 0)[1])
