# Keeps every connection open, answers each line, and prints how many there were at once.
import asyncio
import sys

wanted = int(sys.argv[1])
present = 0


async def handle(reader, writer):
    global present
    present += 1
    if present == wanted:
        print("all", present, flush=True)
    while line := await reader.readline():
        writer.write(b"yes " + line)
    present -= 1
    writer.close()
    if present == 0:
        print("none", flush=True)


async def main():
    server = await asyncio.start_server(handle, None, 7001, backlog=200)
    async with server:
        await server.serve_forever()


asyncio.run(main())
