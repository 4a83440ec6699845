# HTTP/1.1 as servers and clients of the standard library do it: connections kept and reused, chunked bodies both
# ways, 100-continue, several requests at once on one connection, ranges, a body that ends too early.
# Arguments: server | client HOST
import http.client, http.server, io, socket, sys, threading, time

PORT = 8080
DATA = bytes(i * i % 251 for i in range(200_000))


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    timeout = 0.8
    connections = requests = 0

    def setup(self):
        super().setup()
        Handler.connections += 1

    def log_message(self, *_):
        pass

    def body(self):
        if self.headers.get("Transfer-Encoding") != "chunked":
            return self.rfile.read(int(self.headers.get("Content-Length", 0)))
        data = b""
        while size := int(self.rfile.readline().split(b";")[0], 16):
            data += self.rfile.read(size)
            self.rfile.readline()
        self.rfile.readline()
        return data

    def do_GET(self):
        Handler.requests += 1
        if self.path == "/chunks":
            self.send_response(200)
            self.send_header("Transfer-Encoding", "chunked")
            self.end_headers()
            for begin in range(0, len(DATA), 3001):
                part = DATA[begin:begin + 3001]
                self.wfile.write(b"%x\r\n%s\r\n" % (len(part), part))
            self.wfile.write(b"0\r\n\r\n")
            return
        data, status = (b"%d %d\n" % (Handler.connections, Handler.requests), 200) if self.path == "/count" else (DATA, 200)
        if self.path == "/cut":
            self.send_response(200)
            self.send_header("Content-Length", str(len(DATA)))
            self.end_headers()
            self.wfile.write(DATA[:1000])
            self.close_connection = True
            return
        if wish := self.headers.get("Range"):
            first, last = map(int, wish.split("=")[1].split("-"))
            data, status = data[first:last + 1], 206
        self.send_response(status)
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def do_PUT(self):
        Handler.requests += 1
        data = self.body()
        self.send_response(201 if data == DATA else 400)
        self.send_header("Content-Length", "0")
        self.end_headers()

    def handle_expect_100(self):
        if int(self.headers.get("Content-Length", 0)) > 1_000_000:
            self.send_error(417)
            return False
        return super().handle_expect_100()


def client(host):
    one = http.client.HTTPConnection(host, PORT, timeout=3)
    for _ in range(50):
        try:
            one.connect()
            break
        except ConnectionRefusedError:
            time.sleep(0.1)

    def get(path, **headers):
        one.request("GET", path, headers=headers)
        answer = one.getresponse()
        return answer.status, answer.read()

    print("whole", get("/data")[1] == DATA)
    print("chunks", get("/chunks")[1] == DATA)
    print("range", get("/data", Range="bytes=10-19")[1] == DATA[10:20])
    one.request("PUT", "/data", body=(DATA[i:i + 777] for i in range(0, len(DATA), 777)), encode_chunked=True,
                headers={"Transfer-Encoding": "chunked"})
    answer = one.getresponse()
    print("put", answer.status, answer.read())
    print("same", get("/count"))
    raw = socket.create_connection((host, PORT), timeout=3)
    raw.sendall(b"GET /count HTTP/1.1\r\nHost: x\r\n\r\n" * 3 + b"GET /chunks HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n")
    answers = raw.makefile("rb").read()
    print("at once", answers.count(b"200 OK"), len(answers) > len(DATA), answers[-5:])
    raw = socket.create_connection((host, PORT), timeout=3)
    lines = raw.makefile("rb")

    def head():
        return [line for line in iter(lines.readline, b"\r\n") if not line.startswith((b"Server", b"Date"))]

    raw.sendall(b"PUT /data HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: %d\r\n\r\n" % len(DATA))
    print("go on", head())
    raw.sendall(DATA)
    print("then", head())
    raw.sendall(b"PUT /data HTTP/1.1\r\nHost: x\r\nExpect: 100-continue\r\nContent-Length: 2000000\r\n\r\n")
    print("not", head()[0])
    one.request("GET", "/cut")
    try:
        one.getresponse().read()
    except http.client.IncompleteRead as error:
        print("cut", len(error.partial))
    one.close()
    idle = socket.create_connection((host, PORT), timeout=3)
    begin = time.monotonic()
    print("idle", idle.recv(10), 0.7 < time.monotonic() - begin < 2)
    workers = [threading.Thread(target=lambda: results.append(http_get(host))) for _ in range(12)]
    results = []
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    print("beside", results.count(DATA))
    sys.stdout.flush()


def http_get(host):
    connection = http.client.HTTPConnection(host, PORT, timeout=3)
    connection.request("GET", "/data")
    return connection.getresponse().read()


if sys.argv[1] == "server":
    server = http.server.ThreadingHTTPServer(("", PORT), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    time.sleep(8)
    print("served", Handler.requests, flush=True)
else:
    client(sys.argv[2])
