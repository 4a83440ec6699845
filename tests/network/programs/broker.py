# A broker of MQTT 3.1.1 and its clients, as far as they need: topics with wildcards, kept messages, QoS 1, last
# wills of clients that vanish, keep-alive. Arguments: broker | device NAME HOST | watcher HOST
import selectors, socket, struct, sys, time

PORT = 1883


def text(value):
    data = value.encode() if isinstance(value, str) else value
    return struct.pack("!H", len(data)) + data


def packet(kind, body=b"", flags=0):
    size, length = len(body), b""
    while True:
        digit, size = size % 128, size // 128
        length += bytes([digit | (0x80 if size else 0)])
        if not size:
            return bytes([kind << 4 | flags]) + length + body


def take_packet(buffer):
    """First byte and body of the first whole packet, which is taken out of the buffer, or None."""
    size = shift = 0
    for at in range(1, 5):
        if at >= len(buffer):
            return None
        size |= (buffer[at] & 0x7F) << shift
        shift += 7
        if buffer[at] < 0x80:
            break
    begin = at + 1
    if len(buffer) < begin + size:
        return None
    whole = buffer[0], bytes(buffer[begin:begin + size])
    del buffer[:begin + size]
    return whole


def take_text(body, at):
    end = at + 2 + struct.unpack_from("!H", body, at)[0]
    return body[at + 2:end], end


def matches(wish, topic):
    wish, topic = wish.split("/"), topic.split("/")
    for i, part in enumerate(wish):
        if part == "#":
            return True
        if i >= len(topic) or part not in ("+", topic[i]):
            return False
    return len(wish) == len(topic)


class Broker:
    def __init__(self):
        self.selector = selectors.DefaultSelector()
        self.listener = socket.create_server(("", PORT))
        self.listener.setblocking(False)
        self.selector.register(self.listener, selectors.EVENT_READ)
        self.clients, self.kept = {}, {}

    def run(self, seconds):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            for key, events in self.selector.select(min(left, 0.25)):
                if key.fileobj is self.listener:
                    self.accept()
                    continue
                if events & selectors.EVENT_WRITE:
                    self.flush(key.fileobj)
                if events & selectors.EVENT_READ and key.fileobj in self.clients:
                    self.read(key.fileobj)
            now = time.monotonic()
            for connection in [c for c, state in self.clients.items() if state["due"] < now]:
                self.lose(connection, "silent")

    def accept(self):
        while True:
            try:
                connection, _ = self.listener.accept()
            except BlockingIOError:
                return
            connection.setblocking(False)
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.clients[connection] = {"in": bytearray(), "out": bytearray(), "name": "", "wishes": [], "will": None,
                                        "due": float("inf"), "keep": 0}
            self.selector.register(connection, selectors.EVENT_READ)

    def read(self, connection):
        state = self.clients[connection]
        try:
            data = connection.recv(4096)
        except BlockingIOError:
            return
        except ConnectionResetError:
            return self.lose(connection, "reset")
        if not data:
            return self.lose(connection, "gone")
        state["in"] += data
        while (whole := take_packet(state["in"])) is not None:
            self.handle(connection, state, *whole)
        if state["keep"]:
            state["due"] = time.monotonic() + 1.5 * state["keep"]

    def handle(self, connection, state, head, body):
        kind = head >> 4
        if kind == 1:  # CONNECT
            flags, state["keep"] = body[7], struct.unpack_from("!H", body, 8)[0]
            name, at = take_text(body, 10)
            state["name"] = name.decode()
            if flags & 4:
                topic, at = take_text(body, at)
                state["will"] = topic.decode(), take_text(body, at)[0]
            print("connected", state["name"], flush=True)
            self.send(connection, packet(2, b"\0\0"))
        elif kind == 3:  # PUBLISH
            topic, at = take_text(body, 0)
            if head >> 1 & 3:
                self.send(connection, packet(4, body[at:at + 2]))
                at += 2
            self.publish(topic.decode(), body[at:], head & 1)
        elif kind == 8:  # SUBSCRIBE
            number, at = body[:2], 2
            answers = b""
            while at < len(body):
                wish, at = take_text(body, at)
                at += 1
                answers += b"\0"
                state["wishes"].append(wish.decode())
                for topic, data in sorted(self.kept.items()):
                    if matches(wish.decode(), topic):
                        self.send(connection, packet(3, text(topic) + data, 1))
            self.send(connection, packet(9, number + answers))
        elif kind == 12:  # PINGREQ
            self.send(connection, packet(13))
        elif kind == 14:  # DISCONNECT
            state["will"] = None
            self.lose(connection, "well")

    def publish(self, topic, data, keep):
        if keep:
            self.kept[topic] = data
        for connection, state in list(self.clients.items()):
            if any(matches(wish, topic) for wish in state["wishes"]):
                self.send(connection, packet(3, text(topic) + data))

    def send(self, connection, data):
        self.clients[connection]["out"] += data
        self.flush(connection)

    def flush(self, connection):
        out = self.clients[connection]["out"]
        try:
            while out:
                del out[:connection.send(out)]
        except BlockingIOError:
            pass
        except (BrokenPipeError, ConnectionResetError):
            return
        self.selector.modify(connection, selectors.EVENT_READ | (selectors.EVENT_WRITE if out else 0))

    def lose(self, connection, how):
        state = self.clients.pop(connection)
        print("lost", state["name"], how, flush=True)
        self.selector.unregister(connection)
        connection.close()
        if state["will"]:
            self.publish(*state["will"], 0)


class Client:
    def __init__(self, host, name, keep=60, will=None):
        for _ in range(50):
            try:
                self.socket = socket.create_connection((host, PORT), timeout=5)
                break
            except ConnectionRefusedError:
                time.sleep(0.1)
        self.buffer = bytearray()
        body = text("MQTT") + bytes([4, 2 | (4 if will else 0)]) + struct.pack("!H", keep) + text(name)
        if will:
            body += text(will[0]) + text(will[1])
        self.socket.sendall(packet(1, body))
        self.expect(2)

    def next(self):
        while (whole := take_packet(self.buffer)) is None:
            data = self.socket.recv(1000)
            if not data:
                return None
            self.buffer += data
        return whole

    def expect(self, kind):
        head, body = self.next()
        assert head >> 4 == kind, (head, body)
        return body

    def publish(self, topic, data, quality=0, keep=0):
        number = struct.pack("!H", 7) if quality else b""
        self.socket.sendall(packet(3, text(topic) + number + data, quality << 1 | keep))
        if quality:
            assert self.expect(4) == number


if sys.argv[1] == "broker":
    Broker().run(5)
elif sys.argv[1] == "device":
    name = sys.argv[2]
    client = Client(sys.argv[3], name, 60, ("lost/" + name, b"last will"))
    client.publish(f"robots/{name}/place", b"kept", keep=1)
    time.sleep(0.8)
    for i in range(5):
        client.publish(f"robots/{name}/count", b"%d" % i, quality=1)
    client.publish(f"robots/{name}/picture", bytes(range(256)) * 400)  # more than a segment, length of 3 octets
    client.socket.sendall(packet(12))
    client.expect(13)
    time.sleep(0.3)
    if name == "polite":
        client.socket.sendall(packet(14))
        print("end", client.next())
    elif name == "rude":
        client.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        client.socket.close()
    elif name == "silent":
        client.socket.sendall(packet(1, text("MQTT") + bytes([4, 2 | 4]) + struct.pack("!H", 1) + text(name) +
                                     text("lost/silent") + text("will of a silent one")))
        client.expect(2)
        print("end", client.next())  # the broker gives it up
    sys.stdout.flush()
else:
    time.sleep(0.4)
    client = Client(sys.argv[2], "watcher")
    client.socket.sendall(packet(8, b"\0\1" + text("robots/+/place") + b"\0" + text("lost/#") + b"\0", 2))
    client.socket.settimeout(0.3)
    client.socket.sendall(packet(8, b"\0\2" + text("robots/+/count") + b"\0" + text("robots/+/picture") + b"\0", 2))
    seen = {}
    end = time.monotonic() + 3.6
    while time.monotonic() < end:
        try:
            head, body = client.next()
        except TimeoutError:
            continue
        if head >> 4 == 3:
            topic, at = take_text(body, 0)
            seen.setdefault(topic.decode(), []).append(body[at:] if len(body) < 99 else len(body) - at)
        else:
            print("answer", head >> 4, body)
    for topic in sorted(seen):
        print(topic, seen[topic])
    sys.stdout.flush()
