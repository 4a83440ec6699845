# What calls of sockets answer on a board: one line each, of the same program on any Linux.
import errno, fcntl, os, select, signal, socket, struct, subprocess, sys, threading, time


def name_of(error):
    return errno.errorcode.get(error.errno, str(error))


def attempt(what, call):
    try:
        print(what, call())
    except OSError as error:
        print(what, name_of(error) if not isinstance(error, socket.gaierror) else "gaierror %d" % error.errno)
    sys.stdout.flush()


stream = lambda: socket.socket(socket.AF_INET, socket.SOCK_STREAM)
datagram = lambda: socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

# Names and interfaces
print("host", socket.gethostname(), socket.gethostbyname(socket.gethostname()))
attempt("unknown", lambda: socket.getaddrinfo("nobody", 80))
attempt("numeric", lambda: socket.getaddrinfo("10.0.0.7", 80, type=socket.SOCK_STREAM)[0][4])
print("name", socket.getnameinfo((socket.gethostbyname(socket.gethostname()), 9), socket.NI_NUMERICSERV))
print("interfaces", socket.if_nameindex())
asker = datagram()
try:
    print("wlan0", socket.inet_ntoa(fcntl.ioctl(asker, 0x8915, struct.pack("256s", b"wlan0"))[20:24]))  # SIOCGIFADDR
except OSError as error:
    print("wlan0", name_of(error))

print("devices", [line.split(":")[0].strip() for line in open("/proc/net/dev").readlines()[2:]])
print("ways", [line.split()[:3] for line in open("/proc/net/route").readlines()[1:]])

# Refusals
attempt("raw", lambda: socket.socket(socket.AF_INET, socket.SOCK_RAW, socket.IPPROTO_ICMP))
attempt("packet", lambda: socket.socket(socket.AF_PACKET, socket.SOCK_RAW))
attempt("six", lambda: socket.socket(socket.AF_INET6, socket.SOCK_STREAM))
attempt("outside", lambda: datagram().sendto(b"x", ("192.168.7.7", 9)))
print("common")
attempt("elsewhere", lambda: datagram().bind(("192.168.7.7", 9)))
# From here on as of any kernel
attempt("unlistened", lambda: stream().accept())
attempt("unconnected", lambda: stream().recv(1))
attempt("undirected", lambda: datagram().send(b"x"))
first = stream()
first.bind(("", 7100))
first.listen(1)
second = stream()
attempt("in use", lambda: second.bind(("", 7100)))
attempt("closed port", lambda: stream().connect(("127.0.0.1", 7101)))

# A connection on the board itself
client = stream()
client.connect(("127.0.0.1", 7100))
server, peer = first.accept()
print("peer", peer[0], client.getpeername(), server.getsockname())
print("inherits", os.get_inheritable(server.fileno()))
client.sendall(b"hello there")
time.sleep(0.001)
print("waiting", struct.unpack("i", fcntl.ioctl(server.fileno(), 0x541B, b"....")))  # FIONREAD
print("peek", server.recv(5, socket.MSG_PEEK), server.recv(100))
server.setblocking(False)
attempt("nothing", lambda: server.recv(1))
server.settimeout(0.05)
begin = time.monotonic()
try:
    server.recv(1)
except socket.timeout:
    print("late", 0.05 <= time.monotonic() - begin < 0.1)
server.settimeout(None)
server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, struct.pack("ll", 0, 70000))
begin = time.monotonic()
attempt("kernel's time-out", lambda: server.recv(1))
print("after", 0.07 <= time.monotonic() - begin < 0.1)
print("select", select.select([server], [client], [], 0.01) == ([], [client], []))
poller = select.epoll()
poller.register(server.fileno(), select.EPOLLIN | select.EPOLLET)
print("quiet", poller.poll(0.01))
client.send(b"ab")
print("edge", len(poller.poll(1)), poller.poll(0.01))
client.send(b"c")
print("edge again", len(poller.poll(1)), server.recv(9))
copy = os.dup(client.fileno())
client.shutdown(socket.SHUT_WR)
print("end", server.recv(9), len(poller.poll(1)))
server.sendall(b"still open")
print("half", client.recv(99), os.read(copy, 0))
server.close()
os.close(copy)

# A large datagram, and much of a stream at once
into = datagram()
into.bind(("127.0.0.1", 7200))
big = bytes(i * 7 & 255 for i in range(60000))
out = datagram()
print("large", out.sendto(big, ("127.0.0.1", 7200)), into.recv(65536) == big)
out.sendto(big, ("127.0.0.1", 7200))
print("cut", into.recv(40000) == big[:40000])
attempt("too large", lambda: out.sendto(bytes(65508), ("127.0.0.1", 7200)))
sender = stream()
sender.connect(("127.0.0.1", 7100))
receiver, _ = first.accept()
feeder = threading.Thread(target=lambda: sender.sendall(big * 5))
feeder.start()
print("all", receiver.recv(300000, socket.MSG_WAITALL) == big * 5)
feeder.join()

# A child has its parent's sockets
parent = stream()
parent.connect(("127.0.0.1", 7100))
taken, _ = first.accept()
if os.fork() == 0:
    taken.sendall(b"from the child")
    os._exit(0)
os.wait()
print("child", parent.recv(99))
told = subprocess.run([sys.executable, "-c", "import os; os.write(%d, b'after exec')" % taken.fileno()],
                      pass_fds=[taken.fileno()])
print("program", told.returncode, parent.recv(99))

# A reset, and a pipe that nobody reads
taken.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
taken.close()
time.sleep(0.001)
attempt("reset", lambda: parent.recv(1))
attempt("broken", lambda: parent.send(b"x"))
if os.fork() == 0:
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    parent.send(b"x")
    os._exit(0)
print("signal", os.wait()[1])

# Threads
listener = stream()
listener.bind(("127.0.0.1", 0))
listener.listen()


def serve():
    one, _ = listener.accept()
    one.sendall(one.recv(10).upper())


thread = threading.Thread(target=serve)
thread.start()
other = stream()
other.connect(listener.getsockname())
other.sendall(b"shout")
print("thread", other.recv(10))
thread.join()

# Non-blocking connection
third = stream()
third.setblocking(False)
print("begun", errno.errorcode[third.connect_ex(("127.0.0.1", 7100))])
select.select([], [third], [])
print("done", third.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR), third.connect_ex(("127.0.0.1", 7100)),
      errno.errorcode[third.connect_ex(("127.0.0.1", 7100))])

# Between processes of the board, without the network
left, right = socket.socketpair()
left.send(b"unix")
print("pair", right.recv(9))
with open("/etc/hosts") as hosts:
    print("hosts", "localhost" in hosts.read())
