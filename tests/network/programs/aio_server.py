# Lines by TCP, datagrams by UDP and a ticker, in one loop.
import asyncio


async def handle(reader, writer):
    while line := await reader.readline():
        print("from", writer.get_extra_info("peername")[0], line, flush=True)
        writer.write(b"you said " + line)
        await writer.drain()
    writer.close()


class Echo(asyncio.DatagramProtocol):
    def connection_made(self, transport):
        self.transport = transport

    def datagram_received(self, data, sender):
        self.transport.sendto(b"echo " + data, sender)


async def tick():
    while True:
        await asyncio.sleep(0.25)
        print("tick", flush=True)


async def main():
    server = await asyncio.start_server(handle, None, 7001)
    await asyncio.get_running_loop().create_datagram_endpoint(Echo, local_addr=("0.0.0.0", 7002))
    asyncio.ensure_future(tick())
    async with server:
        await server.serve_forever()


asyncio.run(main())
