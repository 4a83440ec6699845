"""The decoders of clients/sigrok in sigrok-cli, on exports of shipped scenarios, against `trace decode`."""

import os
import pathlib
import struct
import time
import unittest

from foreign import Exported
from kit import SOURCE, puckloop

BIT = 1 / 115200  # s
TICK = 1e-7  # s, of the files that are made here

ROOM = """
[run]
duration = "{seconds} s"

[arena]
size = ["1 m", "1 m"]

[[robot]]
name = "robot0"
position = ["0 m", "0 m"]
[robot.pic]
firmware = "{image}"
uart1 = "script:ask.txt"
"""


def vcd_of(**lines):
    """Two or more UART lines as VCD: of each (begin in s, bytes)."""
    marks = {name: chr(33 + place) for place, name in enumerate(lines)}
    changes = []
    for name, sent in lines.items():
        for begin, data in sent:
            for place, byte in enumerate(data):
                levels = [0, *[byte >> bit & 1 for bit in range(8)], 1]
                start = begin + 10 * place * BIT
                changes += [(round((start + bit * BIT) / TICK), level, marks[name])
                            for bit, level in enumerate(levels)]
    head = ["$timescale 100 ns $end", "$scope module lines $end",
            *[f"$var wire 1 {mark} {name} $end" for name, mark in marks.items()], "$upscope $end",
            "$enddefinitions $end", "#0", *[f"1{mark}" for mark in marks.values()]]
    body = [f"#{at}\n{level}{mark}" for at, level, mark in sorted(changes)]
    return "\n".join([*head, *body, f"#{max(at for at, _, _ in changes) + 10000}", ""])


class Sigrok(Exported):
    tool = "sigrok-cli"

    def annotations(self, file, decoders, shown):
        form = ["-I", "vcd"] if file.suffix == ".vcd" else []
        out = self.succeeds(self.called(*form, "-i", file, "-P", decoders, "-A", shown,
                                        SIGROKDECODE_DIR=str(SOURCE / "clients" / "sigrok")))
        return [line.split(": ", 1)[1] for line in out.splitlines()]

    def records(self, file, shown="session:actuators:sensors"):
        lines = "uart:rx=robot0.uart/robot0.linux:tx=robot0.uart/robot0.pic:baudrate=115200"
        return self.annotations(file, f"{lines},epuck_record", f"epuck_record={shown}")

    def test_epuck_records(self):
        out = self.run_of("hello", "--duration", "4 s")
        expected = self.decoded(out, "--protocol", "epuck")
        self.assertGreater(len(expected), 60)
        self.assertEqual([wrong for _, wrong in expected if wrong], [])
        file = self.export(out, "sr")
        self.assertEqual(self.records(file), [text for text, _ in expected])
        self.assertEqual(self.records(file, "wrong"), [])
        fields = self.records(file, "linux-field:board-field")
        self.assertEqual(sum(text.startswith("left ") for text in fields),
                         sum(text.startswith("actuators") for text, _ in expected))

    def test_records_that_lost_bytes(self):
        out = self.run_of("hello", "--duration", "4 s",
                          "--fault", "drop link=robot0.uart from=robot0.linux begin=2s for=20ms",
                          "--fault", "drop link=robot0.uart from=robot0.pic begin=3s for=100ms count=1")
        expected = self.decoded(out, "--protocol", "epuck")
        rest = [text.strip("[]") for text, why in expected if text.startswith("[")]
        self.assertTrue(rest)
        implausible = [why for _, why in expected if "neither N nor R" in why]
        self.assertTrue(implausible)
        file = self.export(out, "sr")
        self.assertEqual(self.records(file), [text for text, _ in expected if not text.startswith("[")])
        wrong = self.records(file, "wrong")
        self.assertEqual([text.rsplit(": ", 1)[1] for text in wrong if ": " in text], rest)
        self.assertIn("71 of 72 bytes when Linux sent its next record: " + rest[0], wrong)
        self.assertEqual(len([text for text in wrong if "neither N nor R" in text]), len(implausible))

    def test_range_and_bearing(self):
        out = self.run_of("rab_pair", "--duration", "1 s", keys="record_ir = true")
        file = self.export(out, "sr")
        sent = {}
        for robot in ("leader", "follower"):
            expected = [text.removeprefix("emitters all ") for text, _ in
                        self.decoded(out, "--protocol", "rab", "--link", f"{robot}.ir")]
            self.assertGreater(len(expected), 30)
            for emitter in (1, 12):
                got = self.annotations(file, f"epuck_rab:ir={robot}.ir/{robot}.rab/emitter{emitter}",
                                       "epuck_rab=frame:wrong")
                self.assertEqual(got, expected)
            sent[robot] = expected
        # What the other one's demodulator sees, and with a size that the frames do not have.
        demodulator = "epuck_rab:ir=leader.ir/ir/demod4"
        heard = self.annotations(file, demodulator, "epuck_rab=frame")
        self.assertGreater(len(heard), 30)
        self.assertEqual(set(heard), set(sent["follower"]))
        wrong = self.annotations(file, demodulator + ":bits=8", "epuck_rab=frame:wrong")
        self.assertEqual(len(wrong), len(heard))
        self.assertTrue(all(text.startswith("length: 46 chips, and frames have 30") for text in wrong), wrong[:2])

    def test_xbee(self):
        out = self.run_of("tam_visit", "--duration", "12 s")
        expected = self.decoded(out, "--protocol", "xbee", "--link", "tam0.xbee")
        self.assertGreater(len(expected), 20)
        file = self.export(out, "sr")
        lines = "uart:rx=tam0.xbee/tam0.avr:tx=tam0.xbee/tam0.xbee:baudrate=9600"
        self.assertEqual(self.annotations(file, f"{lines},xbee_api", "xbee_api=rx-frame:tx-frame:rx-wrong:tx-wrong"),
                         [text.removesuffix(" value -") for text, _ in expected])
        # Without escapes the numbers that have some do not fit.
        self.assertTrue(any("check" in text or "length" in text for text in self.annotations(
            file, f"{lines},xbee_api:mode=1", "xbee_api=rx-wrong:tx-wrong")))

    BTCOM = "uart:rx={}:tx={}:baudrate=115200,epuck_btcom"

    def test_btcom_made_here(self):
        picture = bytes([0, 4, 2]) + bytes(range(8))
        file = self.file("btcom.vcd", vcd_of(
            host=[(0.001, b"\r\nv\rd,300,-300\r"), (0.01, bytes([0xB2, 0xBC, 0x2C, 1, 0xD4, 0xFE, 0xB4, 9, 1, 0])),
                  (0.02, bytes([0xB7, 0xAB, 0])), (0.12, b"Y\nB\n"), (0.13, bytes([0x90]))],
            robot=[(0.005, b"v,Version 9\r\nd\r\n"), (0.012, struct.pack("<8h", *range(-4, 4))),
                   (0.023, struct.pack("<300h", *range(300)) + picture + b"\x07"), (0.124, b"z,Command not found\r\n"),
                   (0.128, b"\x0c\x07WELCOME\r\n")]))
        lines = self.BTCOM.format("host", "robot")
        self.assertEqual(self.annotations(file, lines, "epuck_btcom=command"), [
            "V version", "D set speed 300 -300", "binary N proximity", "binary D set speed 300 -300",
            "binary L front LED 9 1", "end of the sequence", "binary I camera parameters", "binary U microphones",
            "end of the sequence", "B body LED"])
        self.assertEqual(self.annotations(file, lines, "epuck_btcom=reply:text"), [
            "v,Version 9", "d", "proximity -4 -3 -2 -1 0 1 2 3", "microphones 0 1 2 3 4 5 6 7 8 9 10 11 ...",
            "camera mode 0 4x2", "microphones index 7", "\\x0c\\x07WELCOME"])
        self.assertEqual(self.annotations(file, lines, "epuck_btcom=wrong"), [
            "Y: there is no such command", "B: 0 parameters, and B has 1", "z,Command not found",
            "binary 90: there is no such command"])

    def test_btcom_of_its_image(self):
        image = pathlib.Path(os.environ.get("PUCKLOOP_IMAGES", "/nonexistent")) / "BTcom_default.hex"
        if not image.is_file():
            self.skipTest("PUCKLOOP_IMAGES has no BTcom_default.hex")
        self.file("ask.txt", "8 56 0d\n8.5 44 2c 33 30 30 2c 2d 33 30 30 0d\n9 b2 af 00\n9.3 59 0d\n")
        out = self.folder / "out"
        self.succeeds(puckloop("run", self.file("room.toml", ROOM.format(seconds=10, image=image)), "--in-process",
                               "--out", out))
        file = self.export(out, "sr")
        lines = self.BTCOM.format("robot0.uart1/robot0.uart1", "robot0.uart1/robot0.pic")
        self.assertEqual(self.annotations(file, lines, "epuck_btcom=command"), [
            "V version", "D set speed 300 -300", "binary N proximity", "binary Q steps", "end of the sequence"])
        replies = self.annotations(file, lines, "epuck_btcom=reply")
        self.assertEqual(replies[:2], ["v,Version 1.1.4 December 2006", "d"])
        self.assertRegex(replies[2], r"^proximity (\d+ ){7}\d+$")
        self.assertRegex(replies[3], r"^steps 1\d\d -1\d\d$")  # 303 steps/s for half a second
        self.assertEqual(self.annotations(file, lines, "epuck_btcom=wrong"),
                         ["Y: there is no such command", "z,Command not found"])

    def test_a_vcd_opens_quickly(self):
        out = self.run_of("hello", "--duration", "10 s")
        file = self.export(out, "vcd")
        begun = time.monotonic()
        shown = self.succeeds(self.called("-I", "vcd", "-i", file, "--show"))
        seconds = time.monotonic() - begun
        self.assertRegex(shown, r"Logic sample count: \d{6,}")
        self.assertLess(seconds, 20)  # 0.3 s on an idle machine; a file of picoseconds did not end


if __name__ == "__main__":
    unittest.main()
