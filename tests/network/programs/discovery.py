# Services that find each other: questions to a group, answers to who asked, one datagram too long for its reader.
# Arguments: service NAME | seeker NAME
import array, select, socket, struct, sys, time

GROUP, PORT = "239.255.255.250", 1900


def joined():
    one = socket.socket(socket.AF_INET, socket.SOCK_DGRAM, socket.IPPROTO_UDP)
    one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    one.bind(("", PORT))
    one.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0"))
    return one


role, name = sys.argv[1], sys.argv[2]
if role == "service":
    group = joined()
    group.settimeout(2.5)
    own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)  # answers come from its port
    own.bind(("", 0))
    asked = 0
    try:
        while True:
            buffer = bytearray(300)
            size, sender = group.recvfrom_into(buffer)
            words = bytes(buffer[:size]).decode().split()
            if words[0] == "SEEK" and words[1] in ("any", name):
                asked += 1
                own.sendto(b"HERE %s %d" % (name.encode(), own.getsockname()[1]), sender)
            elif words[0] == "LEAVE":
                group.setsockopt(socket.IPPROTO_IP, socket.IP_DROP_MEMBERSHIP,
                                 socket.inet_aton(GROUP) + socket.inet_aton("0.0.0.0"))
    except TimeoutError:
        print("asked", asked)
    # Words from who knows the port: the first is longer than there is room.
    own.setblocking(False)
    while select.select([own], [], [], 0.2)[0]:
        data, beside, flags, _ = own.recvmsg(12, 100)
        print(data, flags == socket.MSG_TRUNC, beside)
else:
    time.sleep(0.5)
    asker = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    asker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 2)
    asker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
    found = {}

    def seek(what, wait=0.3):
        asker.sendto(b"SEEK %s 1" % what, (GROUP, PORT))
        asker.settimeout(wait)
        names = []
        try:
            while True:
                data, sender = asker.recvfrom(100)
                word, who, port = data.decode().split()
                found[who] = (sender[0], int(port))
                names.append(who if sender[1] == int(port) else "wrong port")
        except TimeoutError:
            print("found", what.decode(), sorted(names))

    seek(b"any")
    seek(b"one")
    seek(b"nobody")
    asker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 0)
    two = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    two.connect(found["two"])
    two.send(b"longer than twelve")
    two.send(b"")
    two.sendmsg([b"in ", array.array("B", b"parts"), b"!"])
    other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    other.connect(two.getsockname())
    other.send(b"from a stranger")  # a connected socket does not hear it
    two.settimeout(0.1)
    try:
        print("heard", two.recv(100))
    except TimeoutError:
        print("heard nothing")
    asker.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
    asker.sendto(b"LEAVE", (GROUP, PORT))
    time.sleep(0.3)
    seek(b"any")
sys.stdout.flush()
