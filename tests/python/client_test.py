"""The client of clients/python against real runs, in both placements."""

import hashlib
import json
import pathlib
import shutil
import stat
import unittest

from kit import SOURCE, InFolder

import puckloop


def scenario(duration="5 s"):
    made = puckloop.Scenario(run={"duration": duration, "allow": ["program"]}, arena={"size": ["1 m", "1 m"]})
    made.add("box", name="carton", centre=["30 cm", "0 cm"], size=["10 cm", "10 cm", "10 cm"])
    made.add("robot", position=["0 m", "0 m"], pic={"firmware": "own"},
             linux={"program": ["puckloop-control", "--behaviour", "wander", "--duration", "60"], "start": "20 ms"})
    return made


class Client(InFolder):
    def begun(self, name="out", **more):
        run = puckloop.start(scenario(), out=self.folder / name, **more)
        self.addCleanup(run.close)
        return run

    def test_it_stands_still_where_it_is_asked_to(self):
        with self.begun() as run:
            self.assertEqual(run.time_ps, 0)
            self.assertEqual(run.boards, ["robot0.pic"])
            self.assertEqual(run.step(to="100 ms").time_ps, 100_000_000_000)
            self.assertEqual(run.step(for_=0.05).time_ps, 150_000_000_000)
            with self.assertRaisesRegex(puckloop.RequestError, "is not after now"):
                run.step(to="100 ms")
            # Nobody else may speak to it.
            socket = pathlib.Path(json.loads((run.results / "control.json").read_text())["control"])
            self.assertEqual(stat.S_IMODE(socket.stat().st_mode), 0o600)
            self.assertEqual(stat.S_IMODE(socket.parent.stat().st_mode), 0o700)
        self.assertEqual(json.loads((run.results / "control.json").read_text()), {"ended": True})

    def test_a_frame_is_waited_for_and_captured(self):
        with self.begun() as run:
            run.capture(link="robot0.uart", sender="robot0.pic")
            step = run.step(for_="1 s", until={"frame": {"link": "robot0.uart", "from": "robot0.pic"}})
            self.assertTrue(step.met)
            self.assertEqual(step.frame.sender, "robot0.pic")
            self.assertLessEqual(step.time_ps - step.frame.time_ps, 1_000_000_000)
            run.step(for_="200 ms")
            frames = run.frames()
            self.assertEqual(frames[0], step.frame)
            self.assertGreaterEqual(len(frames), 72)
            self.assertEqual(run.frames(), [])
            step = run.step(for_="20 ms", until={"frame": {"link": "robot0.uart", "value": "zz"}})
            self.assertFalse(step.met)

    def test_a_board_that_is_profiled_is_not_driven(self):
        with self.assertRaisesRegex(puckloop.StartError, "--stats: does not go with --control"):
            self.begun(options=["--stats", "all"])

    def test_frames_so_far_are_decoded(self):
        with self.begun() as run:
            run.step(to="1 s")
            records = run.decoded("epuck")
            self.assertEqual(records[0].fields["record"], "session")
            self.assertEqual(records[0].sender, "robot0.linux")
            self.assertTrue(all(record.end_s <= 1.0 for record in records))
            wheels = [record.fields["left"] for record in records if record.fields["record"] == "actuators"]
            self.assertGreater(len(wheels), 3)
            self.assertEqual({record.sender for record in run.decoded(sender="robot0.pic")}, {"robot0.pic"})
            with self.assertRaisesRegex(puckloop.PuckloopError, "robot9.pic"):
                run.decoded(sender="robot9.pic")
            results = run.results
            run.end()
            self.assertGreaterEqual(len(puckloop.decoded(results, "epuck")), len(records))
        with self.assertRaisesRegex(puckloop.PuckloopError, "nowhere"):
            puckloop.decoded(self.folder / "nowhere")

    def test_registers_and_memory_are_read_and_changed(self):
        with self.begun() as run:
            run.step(to="200 ms")
            board = run.board("robot0.pic")
            self.assertGreater(board.register("PC").value, 0)
            led = board.register("TRISA")
            self.assertEqual(led.bits, 16)
            self.assertEqual(board.memory(0x2000, 4).data, board.memory(0x2000, 2).data + board.memory(0x2002, 2).data)
            board.set_memory(0x2400, b"\x12\x34")
            self.assertEqual(board.memory(0x2400, 2).value, 0x3412)
            board.set_register("OC8RS", 0x1234)
            board.set_register("LATA", 0x0040)  # a pin: the board sends a signal
            with self.assertRaisesRegex(puckloop.RequestError, "before its next instruction"):
                run.save(self.folder / "run.snapshot")
            run.step(for_="1 ms")
            self.assertEqual(board.register("OC8RS").value, 0x1234)
            for ask, text in ((lambda: board.register("TRISB1"), 'did you mean "TRISB'),
                              (lambda: board.variable("x"), "has no symbols"),
                              (lambda: board.memory(0x12345, 1), "no data address"),
                              (lambda: run.board("robot0.pik").register("PC"), 'did you mean "robot0.pic"')):
                with self.assertRaisesRegex(puckloop.RequestError, text):
                    ask()
            self.assertEqual(run.step(to="210 ms").time_ps, 210_000_000_000)  # nothing was lost

    def test_a_register_is_waited_for(self):
        with self.begun() as run:
            step = run.step(to="1 s", until={"node": "robot0.pic", "register": "W15", "is": ">", "value": 0x0800})
            self.assertTrue(step.met)
            self.assertLess(step.time_s, 1)

    def test_a_board_goes_on_by_instructions(self):
        tam = SOURCE / "scenarios/tam.toml"
        for scenario, node in ((SOURCE / "scenarios/hello.toml", "robot0.pic"), (tam, "tam0.avr")):
            with puckloop.start(scenario, out=self.folder / node) as run:
                board = run.board(node)
                run.step(for_="300 ms")
                places, times = [], [run.time_ps]
                for _ in range(50):
                    if not board.step():
                        break
                    places.append(board.value("PC"))
                    times.append(run.time_ps)
                self.assertGreater(len(set(places)), 3, node)
                # The first may be waited for, and is seen a microsecond late; the others take one to five cycles each.
                self.assertTrue(all(50e3 < b - a < 400e3 for a, b in zip(times[2:], times[3:])), times)
                before = run.time_ps
                self.assertTrue(board.step(1000))
                self.assertGreater(run.time_ps - before, 1000 * 20e3)
                for wrong in (0, -1, 100_001):
                    with self.assertRaisesRegex(puckloop.RequestError, "1 to 100000"):
                        board.step(wrong)
                with self.assertRaisesRegex(puckloop.RequestError, "has no board 'nobody'"):
                    run.board("nobody").step()

    def test_conditions_and_places_are_texts(self):
        with self.begun() as run:
            board = run.board("robot0.pic")
            step = run.step(to="1 s", until="W15 > 0x800")  # the only board
            self.assertTrue(step.met)
            self.assertTrue(run.step(for_="1 s", until="frame link=robot0.uart from=robot0.pic").met)
            self.assertTrue(run.step(for_="1 s", until="robot0.pic U2STA.TRMT == 1").met)
            self.assertEqual(board.value("U2STA.TRMT"), 1)
            self.assertEqual(board.value("U2STA"), board.register("U2STA").value)
            self.assertEqual(board.value("0x850:4"), int.from_bytes(board.memory(0x850, 4).data, "little"))
            self.assertEqual(board.value("0x850:12"), int.from_bytes(board.memory(0x850, 12).data, "little"))
            for text, wrong in (("TMR1 ~ 3", "is no condition"), ("", "is no condition"), ("frame x", "KEY=VALUE"),
                                ("U2STA.NONE == 1", "has no field 'NONE'"), ("x" * 501, "501 characters"),
                                ("robot1.pic TMR1 == 1", "no board"), ("frame lnik=a", "did you mean"),
                                ("TMR1 == 99999999999999999999", "is no number")):
                with self.assertRaisesRegex(puckloop.RequestError, wrong):
                    run.step(for_="1 s", until=text)
            for text, wrong in (("", "is no register"), ("TMR1 TMR2", "is no register"), ("U2STA.NONE", "no field"),
                                ("99999999999999999999", "is no number"), ("0x850:99999999", "bytes")):
                with self.assertRaisesRegex(puckloop.RequestError, wrong):
                    board.value(text)

    def test_the_same_requests_give_the_same_trace_in_both_placements(self):
        hashes = []
        for in_process in (True, False):
            with self.begun(f"out{in_process}", in_process=in_process) as run:
                run.step(to="300 ms")
                run.act("move carton to 20 cm, 5 cm")
                run.board("robot0.pic").set_memory(0x2600, b"\x01")
                step = run.step(to="600 ms")
                self.assertEqual([act["act"] for act in step.acts], ["move carton to 20 cm, 5 cm"])
                self.assertIn("done", step.acts[0])
                ended = run.end()
                self.assertTrue(ended.success, ended.why)
                hashes.append((ended.report["trace_sha256"], ended.report["simulated_s"]))
        self.assertEqual(hashes[0], hashes[1])

    def test_what_the_world_has_not_heard_yet_is_not_lost(self):
        """A command that waits for the world's next step while the run is begun again: by a fault, typing, going back."""
        hashes = []
        for between in (lambda run: None, lambda run: run.fault("drop link=robot0.uart begin=4900ms count=1 may_not_fire=true")):
            with self.begun(f"out{len(hashes)}") as run:
                run.step(to="600 ms")
                run.act("move carton to 20 cm, 5 cm")
                run.step(for_="100 us")
                between(run)
                acts = list(run.step(to="620 ms").acts)
                self.assertEqual([act["act"] for act in acts], ["move carton to 20 cm, 5 cm"])
                run.step(to="700 ms")
                run.back("650 ms")
                run.step(to="800 ms")
                events = run.end().report["trace_sha256"], (self.folder / f"out{len(hashes)}/events.toml").read_text()
                self.assertIn('move = "carton"', events[1])
                hashes.append(events[0])
        self.assertEqual(len(set(hashes)), 1)

    def test_a_fault_that_only_a_board_refuses_changes_nothing(self):
        with self.begun() as run:
            run.step(to="200 ms")
            for wrong in ("flip node=robot0.pic at=300ms space=register symbol=NOPE bit=3",
                          "flip node=robot0.pic at=300ms space=ram symbol=NOPE bit=3",
                          "flip node=robot0.pic at=300ms space=ram address=0xffffff bit=3",
                          "interrupt node=robot0.pic at=300ms vector=NOPE",
                          "flash node=robot0.pic at=300ms image=/nonexistent.hex",
                          f"flash node=robot0.pic at=300ms image={SOURCE}/firmware/rab/rab.hex"):
                with self.assertRaises(puckloop.RequestError, msg=wrong):
                    run.fault(wrong)
            self.assertEqual(run.step(to="310 ms").time_ps, 310_000_000_000)
            self.assertEqual(run.end().report["faults"], [])

    def test_an_instruction_of_a_board_that_hangs_is_waited_for_100_ms(self):
        with self.begun() as run:
            run.step(to="200 ms")
            run.fault("hang node=robot0.pic begin=210ms for=400ms")
            run.step(to="220 ms")
            self.assertFalse(run.board("robot0.pic").step())
            self.assertAlmostEqual(run.time_ps / 1e9, 320, delta=0.01)

    def test_a_value_that_does_not_fit_is_refused(self):
        with self.begun() as run:
            run.step(to="100 ms")
            board = run.board("robot0.pic")
            for write in (lambda: board.set_register("TMR1", 70_000), lambda: board.set_register("W0", 0x10000)):
                with self.assertRaisesRegex(puckloop.RequestError, "does not fit into 16 bits"):
                    write()

    def test_a_driven_run_is_the_run_itself(self):
        traces = []
        for steps in ((), ("123 ms", "1 s")):
            with self.begun(f"out{len(steps)}") as run:
                for time in steps:
                    run.step(to=time)
                with self.assertRaises(puckloop.RunEnded) as ended:
                    run.step(for_="10 s")
                self.assertTrue(ended.exception.success, str(ended.exception))
                traces.append(run.ended.report["trace_sha256"])
        self.assertEqual(traces[0], traces[1])

    def test_a_snapshot_is_gone_on_from_with_a_fault(self):
        with self.begun("a") as run:
            run.step(to="400 ms")
            snapshot = run.save(self.folder / "run.snapshot")
        with puckloop.from_snapshot(snapshot, out=self.folder / "b") as run:
            self.assertEqual(run.time_ps, 400_000_000_000)
            run.capture(link="robot0.uart", sender="robot0.pic")
            run.step(to="450 ms")
            with self.assertRaisesRegex(puckloop.RequestError, "there is no link 'robot0.uatr'"):
                run.fault("drop link=robot0.uatr from=robot0.pic begin=500ms")
            run.fault("drop link=robot0.uart from=robot0.pic begin=500ms")
            run.step(to="800 ms")
            frames = run.frames()
            self.assertTrue(any(frame.time_s < 0.45 for frame in frames))  # from before the fault
            late = [frame for frame in frames if frame.time_s > 0.51]
            self.assertTrue(late)
            self.assertTrue(all(frame.fault == "drop" for frame in late), late[:1])
            self.assertTrue(run.end().report["faults"])

    def test_a_run_that_went_back_is_the_run_that_never_did(self):
        outcomes = {}
        for in_process in (True, False):
            for goes_back in (False, True):
                out = self.folder / f"{in_process}{goes_back}"
                with puckloop.start(scenario("1 s"), out=out, in_process=in_process) as run:
                    board = run.board("robot0.pic")
                    run.step(to="123.4 ms")
                    run.act("move carton to 20 cm, 5 cm")  # done in a later step
                    board.set_register("TRISA", 0x1234)
                    run.capture(link="robot0.uart", sender="robot0.pic")
                    if goes_back:
                        run.step(to="150 ms")
                        run.back("123.4 ms")  # where both were done: they are taken back
                        run.act("move carton to 20 cm, 5 cm")
                        board.set_register("TRISA", 0x1234)
                        run.step(to="700 ms")
                        run.act("move carton to 0 cm, 20 cm")
                        board.set_register("TRISA", 0)
                        run.step(to="850 ms")
                        run.back("701 ms")  # the world had heard of it, and not done it
                        run.back("650.123 ms")
                        self.assertEqual(run.time_ps, 650_123_000_000)
                        run.back("600 ms")
                        run.back("130 ms")
                    run.step(to="900 ms")
                    register = board.register("TRISA").value
                    frames = run.frames()
                    with self.assertRaisesRegex(puckloop.RequestError, "an earlier time"):
                        run.back("900 ms")
                    run.end()
                files = {name: (out / name).read_bytes() for name in (
                    "trace.csv", "trajectory.csv", "sensors.csv", "objects.csv", "events.toml", "robot0.linux.log")}
                outcomes[in_process, goes_back] = (register, [frame.time_ps for frame in frames], files)
        first = outcomes[True, False]
        self.assertTrue(first[1])
        for outcome in outcomes.values():
            self.assertEqual(outcome[:2], first[:2])
            for name, content in outcome[2].items():
                self.assertEqual(content, first[2][name], name)

    def test_a_fault_found_out_late_is_the_fault_of_the_beginning(self):
        drop = "drop link=robot0.uart from=robot0.pic begin=500ms"
        traces = []
        for late in (False, True):
            with puckloop.start(scenario("1 s"), out=self.folder / f"{late}", faults=() if late else (drop,)) as run:
                run.step(to="400 ms")
                run.act("move carton to 20 cm, 5 cm")
                if late:
                    run.step(to="480 ms")
                    run.fault(drop)
                    self.assertEqual(run.faults, [drop])
                    with self.assertRaisesRegex(puckloop.RequestError, "begins at 0.1 s"):
                        run.fault("sag node=robot0.pic volts=1.5V begin=100ms for=10ms")
                    run.step(to="700 ms")
                    run.back("300 ms")  # the fault stays, the command goes
                    run.step(to="400 ms")
                    run.act("move carton to 20 cm, 5 cm")
                run.step(to="900 ms")
                report = run.end().report
                self.assertGreater(report["faults"][0]["fired"], 0)
                traces.append(report["trace_sha256"])
        self.assertEqual(traces[0], traces[1])

    def test_what_is_typed_is_a_fault_of_the_beginning_and_can_be_done_again(self):
        # At 400 ms two lines one behind the other, and one as the other end a little later.
        words = ['type link=robot0.uart from=robot0.pic begin="0.4 s" data=763d0d baud=115200',
                 'type link=robot0.uart from=robot0.pic begin="0.400260416667 s" data=ff00 baud=115200',
                 'type link=robot0.uart from=robot0.linux begin="0.45 s" data=0041 baud=115200']
        traces = []
        for by_hand in (False, True):
            out = self.folder / f"{by_hand}"
            with puckloop.start(scenario("1 s"), out=out, faults=() if by_hand else words) as run:
                if by_hand:
                    run.step(to="380 ms")
                    run.act("move carton to 20 cm, 5 cm")
                    run.type("robot0.uart", "robot0.pic", "gone")  # taken back
                    run.step(to="390 ms")
                    run.back("350 ms")
                    run.step(to="400 ms")
                    run.capture(link="robot0.uart")
                    run.type("robot0.uart", "robot0.pic", "v=\r")
                    run.type("robot0.uart", "robot0.pic", b"\xff\x00")
                    run.step(to="450 ms")
                    run.type("robot0.uart", "robot0.linux", b"\x00A")
                    run.step(to="700 ms")
                    run.back("420 ms")  # where the first two were typed already, and the last one was not
                    run.step(to="450 ms")
                    run.type("robot0.uart", "robot0.linux", b"\x00A")
                    run.step(to="500 ms")
                    typed = [(frame.sender, frame.byte) for frame in run.frames() if frame.fault == "insert"]
                    self.assertEqual(typed, [("robot0.pic", ord("v")), ("robot0.pic", ord("=")), ("robot0.pic", 13),
                                             ("robot0.pic", 0xff), ("robot0.pic", 0), ("robot0.linux", 0),
                                             ("robot0.linux", ord("A"))])
                    for link, sender, text, wrong in (
                            ("robot0.uatr", "robot0.pic", "x", 'did you mean "robot0.uart"'),
                            ("robot0.world", "robot0.pic", "x", "no serial line"),
                            ("robot0.uart", "robot1.pic", "x", "at no end of robot0.uart"),
                            ("robot0.uart", "robot0.pic", "", "are no bytes"),
                            ("robot0.uart", "robot0.pic", "x" * 4097, "too many")):
                        with self.assertRaisesRegex(puckloop.RequestError, wrong):
                            run.type(link, sender, text)
                    with self.assertRaisesRegex(puckloop.RequestError, "no rate of a serial line"):
                        run.type("robot0.uart", "robot0.pic", "x", baud=0)
                run.step(to="900 ms")
                report = run.end().report
                self.assertEqual([fault["fired"] for fault in report["faults"]], [3, 2, 2])
                traces.append(report["trace_sha256"])
        self.assertEqual(traces[0], traces[1])
        # The file of what was done has it all.
        done = self.folder / "done.toml"
        done.write_text((self.folder / "True/events.toml").read_text())
        self.assertEqual(done.read_text().count("[[fault]]"), 3)
        with puckloop.start(scenario("1 s"), out=self.folder / "again", options=["--events", str(done)]) as run:
            run.step(to="900 ms")
            self.assertEqual(run.end().report["trace_sha256"], traces[0])

    def test_an_image_is_flashed_into_a_running_robot(self):
        # The range-and-bearing firmware is for another chip. The image is built again while the run goes on.
        images = SOURCE / "firmware"
        image = self.folder / "build/robot.hex"
        image.parent.mkdir()
        traces, out = [], self.folder / "out"
        with puckloop.start(scenario("1 s"), out=out) as run:
            board = run.board("robot0.pic")
            run.step(to="300 ms")
            for file, wrong in ((self.folder / "none.hex", "none.hex: no such file"),
                                (SOURCE / "README.md", "no known image format"),
                                (images / "rab/rab.hex", "dsPIC30F6014A"), (images, "directory")):
                with self.assertRaisesRegex(puckloop.RequestError, wrong) as refused:
                    run.flash("robot0.pic", file)
                self.assertNotIn("\n", str(refused.exception))
            with self.assertRaisesRegex(puckloop.RequestError, 'did you mean "robot0.pic"'):
                run.flash("robot0.pik", images / "can/can.hex")
            self.assertEqual(run.time_s, 0.3)
            before = board.memory(0x900, 64)
            run.step(to="400 ms")
            shutil.copy(images / "ears/ears.hex", image)
            run.flash("robot0.pic", image)
            run.step(to="500 ms")
            run.back("350 ms")  # the old program is there again
            run.step(to="400 ms")
            shutil.copy(images / "epuck/epuck_ircom.elf", image)
            run.flash("robot0.pic", image)
            image.write_text("being built\n")
            self.assertEqual(run.time_s, 0.4)
            run.step(for_="1 ms")
            # Going back there and on again finds the image as it was, and its names.
            self.assertEqual(board.variable("frozen").address, 0x93d)
            run.step(to="700 ms")
            run.back("450 ms")
            run.step(to="800 ms")
            run.back("300 ms")
            self.assertEqual(board.memory(0x900, 64), before)
            with self.assertRaisesRegex(puckloop.RequestError, "no symbols"):
                board.variable("frozen")
            run.step(to="400 ms")
            shutil.copy(images / "epuck/epuck_ircom.elf", image)
            run.flash("robot0.pic", image)
            image.unlink()
            run.step(to="900 ms")
            report = run.end().report
        self.assertEqual([fault["fired"] for fault in report["faults"]], [1])
        self.assertEqual([reset["cause"] for reset in report["nodes"]["robot0.pic"]["resets"]], ["POR", "EXTR"])
        flashed = [file for file in report["files"] if file["role"] == "flashed"]
        self.assertEqual([file["node"] for file in flashed], ["robot0.pic"])
        self.assertEqual(flashed[0]["sha256"],
                         hashlib.sha256((images / "epuck/epuck_ircom.elf").read_bytes()).hexdigest())
        traces.append(report["trace_sha256"])
        text = (out / "events.toml").read_text()
        self.assertEqual(text.count("[[fault]]"), 1)
        self.assertIn(flashed[0]["sha256"], text)
        self.assertIn(str(image), text)
        # Again: where it was, with the folder moved, and as a fault in one line.
        again = self.folder / "again.toml"
        again.write_text(text)
        moved = self.folder / "moved"
        line = f'flash node=robot0.pic at="0.4 s" image={images}/epuck/epuck_ircom.elf'
        for name, more in (("b", {"options": ["--events", str(again)]}), ("c", {"faults": [line]}),
                           ("d", {"options": ["--events", str(moved / "events.toml")]})):
            if name == "d":
                shutil.move(out, moved)
            with puckloop.start(scenario("1 s"), out=self.folder / name, **more) as run:
                run.step(to="900 ms")
                traces.append(run.end().report["trace_sha256"])
        self.assertEqual(len(set(traces)), 1, traces)
        # Another image under the same name is not what was flashed.
        copy, = (moved / "flashed").glob(flashed[0]["sha256"][:12] + "-*")
        copy.write_bytes((images / "ears/ears.hex").read_bytes())
        with self.assertRaisesRegex(puckloop.StartError, "another image than the one that was flashed"):
            puckloop.start(scenario("1 s"), out=self.folder / "e", options=["--events", str(moved / "events.toml")])

    def test_interrupts_are_counted_and_nothing_else_changes(self):
        traces = []
        for counted in (False, True):
            with puckloop.start(scenario("1 s"), out=self.folder / f"{counted}") as run:
                run.step(to="400 ms")
                if counted:
                    self.assertNotIn("interrupts", run._ask("where", {"node": "robot0.pic"}))
                    run._ask("interrupts", {"node": "robot0.pic"})
                run.step(to="500 ms")
                if counted:
                    taken = {one["name"]: one for one in run._ask("where", {"node": "robot0.pic"})["interrupts"]}
                    self.assertAlmostEqual(taken["ADC"]["count"], 0.1 / 142.4e-6, delta=15)
                    self.assertAlmostEqual(taken["ADC"]["per_s"], 10 * taken["ADC"]["count"], delta=1)
                    run.back("450 ms")  # they are counted from there on
                    run.step(to="460 ms")
                    taken = {one["name"]: one for one in run._ask("where", {"node": "robot0.pic"})["interrupts"]}
                    self.assertLess(taken["ADC"]["count"], 200)
                    run._ask("interrupts", {"node": "robot0.pic", "count": False})
                    self.assertNotIn("interrupts", run._ask("where", {"node": "robot0.pic"}))
                run.step(to="900 ms")
                traces.append(run.end().report["trace_sha256"])
        self.assertEqual(traces[0], traces[1])

    def test_a_robots_own_image_may_be_built_again_meanwhile(self):
        image = self.folder / "robot.elf"
        first, second = SOURCE / "firmware/epuck/epuck.elf", SOURCE / "firmware/epuck/epuck_ircom.elf"
        traces = []
        for rebuilt in (False, True):
            shutil.copy(first, image)
            with puckloop.start(scenario("1 s"), out=self.folder / f"{rebuilt}",
                                firmware={"robot0.pic": image}) as run:
                run.step(to="200 ms")
                if rebuilt:
                    shutil.copy(second, image)
                run.step(to="400 ms")
                run.back("50 ms")
                run.step(to="300 ms")
                run.flash("robot0.pic", second)
                run.step(to="600 ms")
                run.back("250 ms")
                run.step(to="300 ms")
                run.flash("robot0.pic", image if rebuilt else second)
                run.step(to="900 ms")
                traces.append(run.end().report["trace_sha256"])
        self.assertEqual(traces[0], traces[1])

    def test_text_is_expected_in_simulated_time(self):
        with self.begun() as run:
            dut = run.dut("robot0.uart", "robot0.linux")
            self.assertEqual(dut.expect("\x01", timeout="1 s")[-1], "\x01")  # the wake-up
            with self.assertRaisesRegex(AssertionError, "did not send 'never'"):
                dut.expect("never", timeout="50 ms")

    def test_what_cannot_begin(self):
        with self.assertRaisesRegex(puckloop.StartError, "nowhere.toml"):
            puckloop.start(self.folder / "nowhere.toml")
        with self.assertRaisesRegex(puckloop.StartError, "--paced"):
            puckloop.start("hello", options=["--paced"])

    def test_a_client_that_goes_away_ends_the_run(self):
        run = self.begun()
        run.step(to="100 ms")
        run._line.close()
        self.assertEqual(run._launched.process.wait(60), 1)
        report = json.loads((run.results / "report.json").read_text())
        self.assertFalse(report["success"])
        self.assertIn("its client went away", report["ended_why"])


if __name__ == "__main__":
    unittest.main()
