# asyncio streams: back-pressure, time-outs at every step, half-close, a server that stops with clients, TLS-less
# upgrades, cancelled tasks, a queue of workers. Arguments: server | client HOST
import asyncio, hashlib, sys, time

PORT = 7400


async def answer(reader, writer):
    try:
        while line := await asyncio.wait_for(reader.readline(), 0.7):
            word, *rest = line.decode().split()
            if word == "echo":
                writer.write(" ".join(rest).encode() + b"\n")
            elif word == "big":  # more than the buffers hold: drain() has to wait
                for i in range(int(rest[0])):
                    writer.write(bytes([i % 256]) * 10_000)
                    await writer.drain()
                writer.write_eof()
            elif word == "sum":
                data = await reader.readexactly(int(rest[0]))
                writer.write(hashlib.sha256(data).hexdigest().encode() + b"\n")
            elif word == "rest":  # until the other end has closed its half
                data = await reader.read()
                writer.write(b"%d after the end\n" % len(data))
            elif word == "slow":
                await asyncio.sleep(float(rest[0]))
                writer.write(b"at last\n")
            elif word == "drop":
                writer.transport.abort()
                return
            elif word == "stop":
                stop.set()
                continue
            await writer.drain()
        print("end", flush=True)
    except asyncio.TimeoutError:
        writer.write(b"too slow\n")
        print("time-out", flush=True)
    except (ConnectionError, asyncio.IncompleteReadError) as error:
        print(type(error).__name__, flush=True)
    except asyncio.CancelledError:
        print("cancelled", flush=True)
    finally:
        writer.close()


async def serve():
    global stop
    stop = asyncio.Event()
    server = await asyncio.start_server(answer, "", PORT, backlog=5, limit=4096)
    await asyncio.wait_for(stop.wait(), 20)
    server.close()
    await server.wait_closed()
    print("closed", flush=True)
    await asyncio.sleep(0.5)


async def connect(host):
    for _ in range(50):
        try:
            return await asyncio.open_connection(host, PORT)
        except ConnectionRefusedError:
            await asyncio.sleep(0.1)


async def ask(host, *words, read=None):
    reader, writer = await connect(host)
    for word in words:
        writer.write(word)
    await writer.drain()
    result = await (read(reader, writer) if read else reader.readline())
    writer.close()
    try:
        await writer.wait_closed()
    except ConnectionError as error:
        result = result, type(error).__name__
    return result


async def big(reader, writer):
    await asyncio.sleep(0.3)  # meanwhile the server cannot go on
    total, sizes = hashlib.sha256(), 0
    while data := await reader.read(65_536):
        total.update(data)
        sizes += len(data)
    return sizes, total.hexdigest()[:16]


async def half(reader, writer):
    writer.write_eof()
    return await reader.read()


async def wait(reader, writer):
    begin = time.monotonic()
    try:
        await asyncio.wait_for(reader.readline(), 0.2)
    except asyncio.TimeoutError:
        return "patience is over", 0.19 < time.monotonic() - begin < 1


async def until_closed(reader, writer):
    return [await reader.readline(), await reader.read()]


async def reset(reader, writer):
    try:
        return await reader.read()
    except ConnectionError as error:
        return type(error).__name__


async def too_long(reader, writer):
    try:
        return await reader.readuntil(b"\n")
    except (asyncio.LimitOverrunError, asyncio.IncompleteReadError) as error:
        return type(error).__name__


async def run(host):
    say = lambda what, result: print(what, result, flush=True)
    say("echo", await ask(host, b"echo one two\n"))
    say("many", await asyncio.gather(*(ask(host, b"echo %d\n" % i) for i in range(40))))
    say("big", await ask(host, b"big 150\n", read=big))
    data = bytes(i * 7 % 256 for i in range(300_000))
    say("sum", (await ask(host, b"sum 300000\n", data)) == hashlib.sha256(data).hexdigest().encode() + b"\n")
    say("half", await ask(host, b"rest\n", b"x" * 5000, read=half))
    say("wait", await ask(host, b"slow 0.4\n", read=wait))
    say("slow", await ask(host, b"echo first\n", read=until_closed))
    say("drop", await ask(host, b"drop\n", read=reset))
    say("missing", await ask(host, b"sum 100\n", b"too few", read=half))
    task = asyncio.create_task(ask(host, b"slow 5\n"))
    await asyncio.sleep(0.1)
    task.cancel()
    say("cancelled", (await asyncio.gather(task, return_exceptions=True))[0].__class__.__name__)
    reader, writer = await connect(host)
    writer.write(b"stop\n")
    await asyncio.sleep(0.2)
    writer.write(b"echo still there\n")
    say("after", await reader.readline())
    try:
        await asyncio.open_connection(host, PORT)
        say("refused", False)
    except ConnectionRefusedError:
        say("refused", True)
    writer.close()


asyncio.run(serve() if sys.argv[1] == "server" else run(sys.argv[2]))
