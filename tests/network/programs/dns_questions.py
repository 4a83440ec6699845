# Asks the name server of /etc/resolv.conf by itself, as c-ares, musl and dig do: argument "wait": once a second.
import socket, struct, sys, time

with open("/etc/resolv.conf") as lines:
    servers = [line.split()[1] for line in lines if line.startswith("nameserver")]
print("servers", servers)
asker = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
asker.settimeout(0.5)


def ask(name, kind):
    labels = b"".join(bytes([len(part)]) + part.encode() for part in name.split("."))
    question = struct.pack(">6H", 7, 0x100, 1, 0, 0, 0) + labels + struct.pack(">BHH", 0, kind, 1)
    asker.sendto(question, (servers[0], 53))
    try:
        answer, sender = asker.recvfrom(512)
    except socket.timeout:
        return "no answer"
    assert sender == (servers[0], 53) and answer[12:len(question)] == question[12:]
    status, count = answer[3] & 15, struct.unpack(">H", answer[6:8])[0]
    if count == 0:
        return "status %d" % status
    data = answer[len(question) + 12:]
    return socket.inet_ntoa(data) if kind == 1 else data[1:1 + data[0]].decode()


if sys.argv[1:] == ["wait"]:
    for _ in range(4):
        print("%.1f" % time.monotonic(), ask("server", 1))
        time.sleep(1 - time.monotonic() % 1)
else:
    for name, kind in (("server", 1), ("SERVER", 1), ("nobody", 1), ("server", 28), ("254.0.0.10.in-addr.arpa", 12)):
        print(name, kind, ask(name, kind))
