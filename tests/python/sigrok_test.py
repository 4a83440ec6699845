"""The decoders of clients/sigrok in sigrok-cli, on exports of shipped scenarios, against `trace decode`."""

import time
import unittest

from foreign import Exported
from kit import SOURCE


class Sigrok(Exported):
    tool = "sigrok-cli"

    def annotations(self, file, decoders, shown):
        out = self.succeeds(self.called("-i", file, "-P", decoders, "-A", shown,
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
