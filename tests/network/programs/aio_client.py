# Five connections at a time, a datagram, a connection that takes too long, one that is refused.
import asyncio


async def talk(number):
    await asyncio.sleep(0.2 + 0.01 * number)
    reader, writer = await asyncio.open_connection("server", 7001)
    for line in range(3):
        writer.write(b"client %d line %d\n" % (number, line))
        await writer.drain()
        print(await reader.readline(), flush=True)
        await asyncio.sleep(0.1)
    writer.close()
    await writer.wait_closed()


class Listener(asyncio.DatagramProtocol):
    def datagram_received(self, data, sender):
        print(data, sender, flush=True)


async def main():
    loop = asyncio.get_running_loop()
    await asyncio.gather(*(talk(number) for number in range(5)))
    transport, _ = await loop.create_datagram_endpoint(Listener, remote_addr=("server", 7002))
    transport.sendto(b"hello")
    begin = loop.time()
    try:
        await asyncio.wait_for(asyncio.open_connection("10.0.0.9", 9), 0.5)
    except asyncio.TimeoutError:
        print("timeout", round(loop.time() - begin, 2), flush=True)
    try:
        await asyncio.open_connection("server", 9)
    except OSError as error:
        print(error, flush=True)
    transport.close()


asyncio.run(main())
