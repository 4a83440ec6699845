# Opens many connections, a hundred at a time, talks over all of them, and prints how many answers were right.
import asyncio
import sys
import time

wanted = int(sys.argv[1])


async def talk(number, reader, writer):
    writer.write(b"%d\n" % number)
    return await reader.readline() == b"yes %d\n" % number


async def main():
    await asyncio.sleep(0.2)
    begin = time.monotonic()
    ends = []
    while len(ends) < wanted:
        some = min(100, wanted - len(ends))
        ends += await asyncio.gather(*(asyncio.open_connection("server", 7001) for _ in range(some)))
    opened = time.monotonic() - begin
    right = sum(await asyncio.gather(*(talk(i, *end) for i, end in enumerate(ends))))
    for _, writer in ends:
        writer.close()
    await asyncio.sleep(0.5)
    print(f"opened {len(ends)} right {right}", flush=True)
    print(f"took {opened:.3f} s", file=sys.stderr, flush=True)


asyncio.run(main())
