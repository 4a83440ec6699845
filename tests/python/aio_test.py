"""The asynchronous client against real runs; what cannot be reached, for both clients."""

import asyncio
import json
import os
import socket
import subprocess
import threading
import unittest

from client_test import scenario
from kit import PROGRAM, InFolder

import puckloop
from puckloop import aio


class Asynchronous(InFolder):
    def test_it_is_the_same_run_as_the_synchronous_clients(self):
        with puckloop.start(scenario("1 s"), out=self.folder / "a") as run:
            run.capture(link="robot0.uart", sender="robot0.pic")
            step = run.step(for_="1 s", until={"frame": {"link": "robot0.uart", "from": "robot0.pic"}})
            run.board("robot0.pic").set_memory(0x2600, b"\x01")
            frames, decoded = run.frames(), run.decoded("epuck", sender="robot0.pic")
            trace = run.end().report["trace_sha256"]

        async def other():
            async with await aio.start(scenario("1 s"), out=self.folder / "b") as run:
                await run.capture(link="robot0.uart", sender="robot0.pic")
                again = await run.step(for_="1 s", until={"frame": {"link": "robot0.uart", "from": "robot0.pic"}})
                self.assertEqual(again, step)
                board = run.board("robot0.pic")
                await board.set_memory(0x2600, b"\x01")
                self.assertEqual((await board.memory(0x2600, 1)).value, 1)
                self.assertEqual((await board.register("TRISA")).bits, 16)
                with self.assertRaisesRegex(puckloop.RequestError, 'did you mean "TRISA"'):
                    await board.register("TRISAA")
                self.assertEqual(await run.frames(), frames)
                self.assertEqual(await run.decoded("epuck", sender="robot0.pic"), decoded)
                with self.assertRaisesRegex(puckloop.PuckloopError, "epuk"):
                    await run.decoded("epuk")
                return (await run.end()).report["trace_sha256"]

        self.assertEqual(asyncio.run(other()), trace)

    def test_several_runs_go_on_at_once(self):
        async def one(seed):
            async with await aio.start(scenario("2 s"), out=self.folder / f"run{seed}", seed=seed) as run:
                linux = await run.dut("robot0.uart", "robot0.linux")
                text = await linux.expect("\x01", timeout="1 s")
                await run.step(to="300 ms")
                return text[-1], run.time_s, (await run.end()).success

        async def all_of_them():
            return await asyncio.gather(*[one(seed) for seed in (1, 2, 3)])

        self.assertEqual(asyncio.run(all_of_them()), [("\x01", 0.3, True)] * 3)

    def test_a_call_that_is_cancelled_loses_nothing(self):
        async def cancelled():
            async with await aio.start(scenario(), out=self.folder / "out") as run:
                step = asyncio.create_task(run.step(to="1 s"))
                await asyncio.sleep(0.01)
                step.cancel()
                with self.assertRaises(asyncio.CancelledError):
                    await step
                # The run has done it; its answer is not taken for the next one's.
                step = await run.step(to="1200 ms")
                self.assertEqual(step.time_ps, 1_200_000_000_000)
                with self.assertRaisesRegex(puckloop.RequestError, "is not after now"):
                    await run.step(to="1 s")
                return (await run.end()).success

        self.assertTrue(asyncio.run(cancelled()))

    def test_a_snapshot_and_a_fault(self):
        async def main():
            async with await aio.start(scenario(), out=self.folder / "a") as run:
                await run.step(to="400 ms")
                await run.save(self.folder / "run.snapshot")
            async with await aio.from_snapshot(self.folder / "run.snapshot", out=self.folder / "b") as run:
                self.assertEqual(run.time_ps, 400_000_000_000)
                await run.capture(link="robot0.uart", sender="robot0.pic")
                await run.fault("drop link=robot0.uart from=robot0.pic begin=500ms")
                await run.act("move carton to 20 cm, 5 cm")
                step = await run.step(to="800 ms")
                self.assertIn("done", step.acts[0])
                self.assertTrue(all(frame.fault == "drop" for frame in await run.frames() if frame.time_s > 0.51))
                with self.assertRaisesRegex(puckloop.RequestError, "did you mean"):
                    await run.fault("dropp link=robot0.uart begin=900ms")
                self.assertEqual((await run.step(to="801 ms")).time_s, 0.801)  # as before
                await run.back("450 ms")
                self.assertEqual(run.time_ps, 450_000_000_000)

        asyncio.run(main())


class Unreachable(InFolder):
    def test_no_run_and_one_that_is_over(self):
        with self.assertRaisesRegex(puckloop.StartError, "there is no control.json"):
            puckloop.attach(self.folder)
        self.file("control.json", '{"ended": true}')
        with self.assertRaisesRegex(puckloop.StartError, "the run is over"):
            puckloop.attach(self.folder)
        with self.assertRaisesRegex(puckloop.StartError, "the run is over"):
            asyncio.run(aio.attach(self.folder))

    def test_a_control_file_that_is_not_written_to_its_end(self):
        note = self.file("control.json", "")
        with self.assertRaisesRegex(puckloop.StartError, "did not listen for 5 s"):
            puckloop.attach(self.folder)
        threading.Timer(0.3, note.write_text, ['{"ended": true}']).start()
        with self.assertRaisesRegex(puckloop.StartError, "the run is over"):
            puckloop.attach(self.folder)

    def test_a_socket_that_nobody_serves(self):
        path = str(self.folder / "control")
        self.file("control.json", json.dumps({"control": path}))
        with self.assertRaisesRegex(puckloop.NobodyServes, "nobody serves this socket"):
            puckloop.attach(self.folder)
        bound = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.addCleanup(bound.close)
        bound.bind(path)
        with self.assertRaisesRegex(puckloop.NobodyServes, "nobody serves this socket") as raised:
            asyncio.run(aio.attach(self.folder))
        self.assertNotIn("\n", str(raised.exception))

    def serve(self, *lines):
        """A run that says these lines and goes away."""
        path = str(self.folder / "control")
        self.file("control.json", json.dumps({"control": path}))
        listening = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.addCleanup(listening.close)
        listening.bind(path)
        listening.listen()

        def say():
            for _ in range(2):
                line, _address = listening.accept()
                line.sendall(b"".join(line + b"\n" for line in lines))
                line.close()

        thread = threading.Thread(target=say)
        thread.start()
        self.addCleanup(thread.join)

    def both(self, error, text):
        with self.assertRaisesRegex(error, text):
            puckloop.attach(self.folder)
        with self.assertRaisesRegex(error, text):
            asyncio.run(aio.attach(self.folder))

    def test_another_version_of_the_protocol(self):
        self.serve(b'{"protocol": 2, "version": "9.9"}')
        self.both(puckloop.ProtocolError, r"speaks protocol 2 \(puckloop 9.9\), this client 1")

    def test_something_that_is_no_run(self):
        self.serve(b"220 mail ESMTP")
        self.both(puckloop.ProtocolError, "no JSON")

    def test_a_run_that_goes_away(self):
        self.serve()
        self.both(puckloop.RunEnded, "without a word")

    def test_a_run_begun_by_hand(self):
        file = scenario("2 s").write(self.folder / "by_hand.toml")
        out = self.folder / "out"
        process = subprocess.Popen([PROGRAM, "run", str(file), "--control", "--in-process", "--out", str(out)],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        while not (out / "control.json").is_file():
            self.assertIsNone(process.poll())
        with puckloop.attach(out) as run:
            self.assertEqual(run.step(to="100 ms").time_s, 0.1)
            run.fault("drop link=robot0.uart at=150ms")
            self.assertEqual(run.time_s, 0.1)
            run.step(to="200 ms")
            self.assertTrue(run.end().success)
        self.assertEqual(process.wait(60), 0)

    def test_no_program(self):
        before = os.environ["PUCKLOOP"]
        self.addCleanup(os.environ.__setitem__, "PUCKLOOP", before)
        os.environ["PUCKLOOP"] = str(self.folder / "nowhere")
        with self.assertRaisesRegex(puckloop.StartError, "nowhere: No such file"):
            puckloop.start("hello")


class Tables(InFolder):
    def test_results_are_records(self):
        with puckloop.start(scenario("1 s"), out=self.folder / "out") as run:
            run.end()
            places = puckloop.table(run.results, "trajectory")
            self.assertIsInstance(places[0]["x_m"], float)
            self.assertEqual(puckloop.table(run.results, "trace")[0].keys(),
                             {"time_s", "link", "from", "kind", "value", "detail", "start_s", "period_s", "stretch_s",
                              "fault"})
            with self.assertRaisesRegex(puckloop.PuckloopError, "no such table; there are .*trajectory"):
                puckloop.table(run.results, "trajectories")
            try:
                import pandas  # noqa: F401
            except ImportError:
                with self.assertRaisesRegex(puckloop.PuckloopError, "need pandas"):
                    puckloop.dataframe(places)
            else:
                self.assertEqual(len(puckloop.dataframe(places)), len(places))


if __name__ == "__main__":
    unittest.main()
