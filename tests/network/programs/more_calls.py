# Calls of sockets that servers and tools make, on the board itself: the same lines of any Linux.
import ctypes, errno, os, select, signal, socket, struct, sys, time

ANY = ("127.0.0.1", 0)


def name_of(error):
    return errno.errorcode.get(error.errno, str(error))


def attempt(what, call):
    try:
        print(what, call())
    except OSError as error:
        print(what, name_of(error))
    sys.stdout.flush()


def pair(port):
    listener = socket.create_server(("127.0.0.1", port))
    client = socket.create_connection(("127.0.0.1", port))
    server, _ = listener.accept()
    listener.close()
    return client, server


def datagrams():
    into, out = (socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2))
    into.bind(ANY)
    out.connect(into.getsockname())
    return into, out


# What is written in pieces goes out as one, and what is too little does not wake a reader.
client, server = pair(7301)
client.setsockopt(socket.IPPROTO_TCP, socket.TCP_CORK, 1)
client.send(b"a")
client.send(b"b")
time.sleep(0.02)
attempt("corked", lambda: server.recv(9, socket.MSG_DONTWAIT))
client.setsockopt(socket.IPPROTO_TCP, socket.TCP_CORK, 0)
time.sleep(0.02)
attempt("uncorked", lambda: server.recv(9, socket.MSG_DONTWAIT))
client.send(b"c", socket.MSG_MORE)
time.sleep(0.02)
attempt("more", lambda: server.recv(9, socket.MSG_DONTWAIT))
client.send(b"d")
time.sleep(0.02)
attempt("all", lambda: server.recv(9, socket.MSG_DONTWAIT))
client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)  # no acknowledgement is waited for
server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVLOWAT, 4)
client.send(b"ab")
time.sleep(0.02)
print("low", select.select([server], [], [], 0.02)[0] == [])
client.send(b"cd")
print("enough", len(select.select([server], [], [], 1)[0]), server.recv(9))
server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVLOWAT, 1)
server.setblocking(False)
server.shutdown(socket.SHUT_RD)
print("shut", server.recv(9))
client.send(b"still")
time.sleep(0.02)
print("after it", server.recv(9), server.recv(9))

# What comes beside a datagram
into, out = datagrams()
for name in (socket.IP_PKTINFO if hasattr(socket, "IP_PKTINFO") else 8, 12, 13):  # IP_RECVTTL, IP_RECVTOS
    into.setsockopt(socket.IPPROTO_IP, name, 1)
into.setsockopt(socket.SOL_SOCKET, 29, 1)  # SO_TIMESTAMP
out.setsockopt(socket.IPPROTO_IP, socket.IP_TOS, 16)
out.setsockopt(socket.IPPROTO_IP, socket.IP_TTL, 33)
out.send(b"beside")
data, beside, flags, _ = into.recvmsg(20, 512)
print(data, flags)
for level, kind, value in beside:
    if kind == 29:
        seconds, micro = struct.unpack("ll", value)
        value = abs(seconds + micro * 1e-6 - time.time()) < 1
    print(level, kind, value)
out.send(b"no room")
print(into.recvmsg(3)[::2])

# Nobody is there: an error, and nothing to read
gone = into.getsockname()
into.close()
out.send(b"x")
time.sleep(0.02)
poller = select.poll()
poller.register(out, select.POLLIN)
print("error", [event for _, event in poller.poll(100)])
attempt("refused", lambda: out.recv(1, socket.MSG_DONTWAIT))

# From the board alone to another one
bound = socket.socket()
bound.bind(ANY)
attempt("leaves", lambda: bound.connect(("8.8.8.8", 53)))

# Several that share a port get their share
shared = []
for _ in range(2):
    one = socket.socket()
    one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    one.bind(("127.0.0.1", 7302))
    one.listen(40)
    shared.append(one)
clients = [socket.create_connection(("127.0.0.1", 7302)) for _ in range(30)]
shares = []
for one in shared:
    one.setblocking(False)
    shares.append(0)
    try:
        while True:
            one.accept()[0].close()
            shares[-1] += 1
    except BlockingIOError:
        pass
print("shares", sum(shares), min(shares) > 2)

# Epolls in an epoll, in poll() and in select()
inner, outer = select.epoll(), select.epoll()
client, server = pair(7303)
inner.register(server.fileno(), select.EPOLLIN)
outer.register(inner.fileno(), select.EPOLLIN)
poller = select.poll()
poller.register(inner.fileno(), select.POLLIN)
print("quiet", outer.poll(0.01), poller.poll(10), select.select([inner], [], [], 0.01)[0])
client.send(b"x")
print("news", len(outer.poll(1)), len(poller.poll(1000)), len(select.select([inner], [], [], 1)[0]), len(inner.poll(1)))
server.recv(1)
print("quiet", outer.poll(0.01), poller.poll(10))
inner.close()
again = select.epoll()
again.register(server.fileno(), select.EPOLLIN)
client.send(b"y")
print("another", len(again.poll(1)), server.recv(1))

# A connection that a server hands to its worker
ours, theirs = socket.socketpair()
client, server = pair(7304)
worker = os.fork()
if worker == 0:
    ours.close()
    _, descriptors, _, _ = socket.recv_fds(theirs, 10, 2)
    taken = socket.socket(fileno=descriptors[0])
    taken.sendall(taken.recv(9).upper())
    os._exit(len(descriptors))
theirs.close()
late_client, late = pair(7305)  # the worker was made before
socket.send_fds(ours, [b"take"], [late.fileno()])
late.close()
late_client.sendall(b"work")
print("worker", late_client.recv(9), late_client.recv(9), os.waitstatus_to_exitcode(os.wait()[1]))
left, right = socket.socketpair()
socket.send_fds(left, [b"own"], [server.fileno()])
same = socket.socket(fileno=socket.recv_fds(right, 9, 1)[1][0])
server.close()
client.send(b"to the other descriptor")
print("own", same.recv(99))
same.close()
print("closed", client.recv(9))

# Addresses by number
for node, family, flags in ((None, socket.AF_INET6, socket.AI_PASSIVE), (None, socket.AF_INET6, 0), ("::1", 0, 0),
                            (None, socket.AF_INET, socket.AI_PASSIVE), ("127.0.0.9", 0, 0)):
    print("address", socket.getaddrinfo(node, 80, family, socket.SOCK_STREAM, 0, flags)[0][4][:2])

# An alarm ends a wait
signal.signal(signal.SIGALRM, lambda number, frame: None)
waiter = ctypes.CDLL(None, use_errno=True)
for what in ("epoll_wait", "poll"):
    signal.setitimer(signal.ITIMER_REAL, 0.03)
    room = ctypes.create_string_buffer(64)
    if what == "poll":
        struct.pack_into("ihh", room, 0, client.fileno(), select.POLLPRI, 0)
    found = waiter.poll(room, 1, 500) if what == "poll" else waiter.epoll_wait(outer.fileno(), room, 1, 500)
    print(what, found, errno.errorcode.get(ctypes.get_errno()))

# Nothing comes any more, for those that wait
into, out = datagrams()
into.setblocking(False)
attempt("unconnected", lambda: into.shutdown(socket.SHUT_RD))
attempt("shut datagrams", lambda: into.recv(9))
into.setblocking(True)
attempt("waiting", lambda: into.recv(9))

# Options that servers set
one = socket.socket()
for level, name, value in ((socket.IPPROTO_TCP, socket.TCP_MAXSEG, 1000), (socket.IPPROTO_TCP, socket.TCP_SYNCNT, 3),
                           (socket.IPPROTO_TCP, socket.TCP_LINGER2, 5), (socket.IPPROTO_TCP, 25, 4096),
                           (socket.IPPROTO_IP, 10, 0), (socket.IPPROTO_IP, 11, 1), (socket.SOL_SOCKET, 5, 1)):
    one.setsockopt(level, name, value)
    print(level, name, one.getsockopt(level, name))
attempt("device", lambda: one.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, b"nowhere"))
attempt("congestion", lambda: one.setsockopt(socket.IPPROTO_TCP, socket.TCP_CONGESTION, b"nowhere"))
attempt("type", lambda: socket.socket(socket.AF_INET, 11))
