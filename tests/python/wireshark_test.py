"""clients/wireshark/puckloop.lua in tshark, on exports of shipped scenarios, against `trace decode`."""

import csv
import unittest

from foreign import Exported
from kit import SOURCE

SCRIPT = SOURCE / "clients" / "wireshark" / "puckloop.lua"


class Wireshark(Exported):
    tool = "tshark"

    def fields(self, file, shown, *fields, passes=1):
        """Of each packet that the filter shows the fields, as text; of one with several values those with commas."""
        words = [word for field in fields for word in ("-e", field)]
        ended = self.called("-X", f"lua_script:{SCRIPT}", "-r", file, *["-2"] * (passes - 1), "-Y", shown,
                            "-T", "fields", *words)
        self.assertNotIn("Lua", ended.stderr)
        return [line.split("\t") for line in self.succeeds(ended).splitlines()]

    def test_epuck_records_whole_and_cut(self):
        out = self.run_of("hello", "--duration", "4 s")
        expected = self.decoded(out, "--protocol", "epuck")
        file = self.export(out, "pcapng")
        for passes in (1, 2):
            rows = self.fields(file, "epuck.record", "_ws.col.Info", passes=passes)
            # `trace decode` has more of a sensor record.
            shown = [part for row in rows for part in row[0].split(" | ")]
            self.assertEqual(len(shown), len(expected))
            for text, (whole, _) in zip(shown, expected):
                self.assertTrue(whole.startswith(text), (text, whole))
        self.assertTrue(self.fields(file, "epuck.packet", "frame.number"))  # actuators come in two packets
        self.assertEqual(self.fields(file, "_ws.malformed || epuck.wrong || epuck.incomplete", "frame.number"), [])
        lefts = [row[0] for row in self.fields(file, "epuck.left", "epuck.left")]
        self.assertEqual(lefts, [text.split()[2] for text, _ in expected if text.startswith("actuators")])
        lights = [row[0].replace(",", " ") for row in self.fields(file, "epuck.light", "epuck.light")]
        self.assertEqual(lights, [text.split(" light ")[1].split(" acc")[0] for text, _ in expected
                                  if text.startswith("sensors")])

    def test_records_that_lost_bytes(self):
        out = self.run_of("hello", "--duration", "4 s",
                          "--fault", "drop link=robot0.uart from=robot0.linux begin=2s for=20ms",
                          "--fault", "drop link=robot0.uart from=robot0.pic begin=3s for=100ms count=1")
        expected = self.decoded(out, "--protocol", "epuck")
        file = self.export(out, "pcapng")
        rest = [text.strip("[]").replace(" ", "") for text, _ in expected if text.startswith("[")]
        self.assertTrue(rest)
        self.assertEqual([row[0] for row in self.fields(file, "epuck.incomplete", "epuck.incomplete")], rest)
        self.assertEqual(len(self.fields(file, "epuck.left", "epuck.left")),
                         len([text for text, _ in expected if text.startswith("actuators")]))
        wrong = [row[0] for row in self.fields(file, "epuck.wrong", "_ws.expert.message")]
        self.assertTrue(any("71 of 72 bytes when Linux sent its next record" in text for text in wrong), wrong)
        self.assertTrue(any("reset is 00, neither N nor R" in text for text in wrong), wrong)

    def test_registers(self):
        out = self.run_of("rab_pair", "--duration", "1 s")
        expected = self.decoded(out, "--protocol", "i2c", "--link", "leader.i2c.linux")
        file = self.export(out, "pcapng")
        parts = [part for text, _ in expected for part in text.split(" | ")]
        rows = self.fields(file, 'epuck_i2c && frame.interface_name == "leader.i2c"', "_ws.col.Info")
        self.assertGreater(len(rows), 100)
        words = [row[0].split() for row in rows]
        self.assertEqual([(one[1], one[2]) for one in words],
                         [(one[1], one[2]) for one in (part.split() for part in parts)])
        self.assertEqual([one[3].lower() for one in words], [part.split()[3].lower() for part in parts])
        self.assertEqual([row[0].lower().replace(" ", "") for row in rows],
                         [part.lower().replace(" ", "") for part in parts])
        self.assertTrue(self.fields(file, 'epuck_i2c.name == "DATA_15_8"', "epuck_i2c.read"))

    def test_xbee_and_mesh(self):
        out = self.run_of("tam_visit")
        file = self.export(out, "pcapng")
        for link, sender in (("tam0.xbee", "tam0.avr"), ("tam0.xbee", "tam0.xbee"),
                             ("coordinator.uart", "coordinator.linux"), ("coordinator.uart", "coordinator.xbee")):
            expected = [text.removesuffix(" value -") for text, _ in
                        self.decoded(out, "--protocol", "xbee", "--link", link, "--from-node", sender)]
            self.assertGreater(len(expected), 5)
            rows = self.fields(file, f'xbee && frame.interface_name == "{link} {sender}"', "_ws.col.Info")
            shown = [part.replace(" ", "") for row in rows for part in row[0].split(" | ")]
            self.assertEqual(shown, [text.replace(" ", "") for text in expected])
        expected = [text for text, _ in self.decoded(out, "--protocol", "mesh")]
        rows = self.fields(file, "xbee_mesh", "xbee_mesh.origin", "xbee_mesh.sequence", "xbee_mesh.data")
        self.assertGreater(len(rows), 40)
        self.assertEqual([tuple(row) for row in rows],
                         [self.mesh_of(text) for text in expected if " sequence " in text])

    def test_bluetooth(self):
        out = self.run_of("bluetooth", "--duration", "30 s")
        file = self.export(out, "pcapng")
        for link in ("caller.bluetooth", "listener.bluetooth"):
            for sender in (link.replace("bluetooth", "pic"), "bluetooth"):
                expected = [" ".join(text.split()[:2]) for text, _ in
                            self.decoded(out, "--protocol", "bluetooth", "--link", link, "--from-node", sender)
                            if text.split()[0] in ("REQ", "CFM", "IND", "RSP")]
                rows = self.fields(file, f'lmx9820 && frame.interface_name == "{link} {sender}"', "_ws.col.Info")
                shown = [" ".join(part.split()[:2]) for row in rows for part in row[0].split(" | ")]
                self.assertEqual(shown, expected)
                if link.startswith("caller"):
                    self.assertGreater(len(shown), 4)
        self.assertEqual(self.fields(file, "lmx9820.wrong", "frame.number"), [])
        found = self.fields(file, "lmx9820.opcode == 1", "lmx9820.data")
        self.assertEqual(found[0][0][:12], "d2042c170008")  # 08:00:17:2C:04:D2, its low byte first

    @staticmethod
    def mesh_of(text):
        """Origin, sequence and data of a line of `trace decode`."""
        ways, _, rest = text.partition(" sequence ")
        sequence, _, data = rest.partition(" data ")
        return "0x" + ways.split(" -> ")[0].split()[-1], sequence, data.replace(" ", "")

    def test_packets_are_in_order_and_were_on_the_air(self):
        out = self.run_of("tam_visit")
        file = self.export(out, "pcapng")
        times = [float(row[0]) for row in self.fields(file, "frame", "frame.time_epoch")]
        self.assertGreater(len(times), 2000)
        self.assertEqual(times, sorted(times))
        with open(out / "trace.csv", newline="") as trace:
            rows = [row for row in csv.DictReader(trace) if row["kind"] == "radio"]
        aired = [row for row in rows if float(row["period_s"]) > 0]  # how long it takes
        self.assertLess(len(aired), len(rows))  # the rest is what modules give their medium of their settings
        self.assertEqual(len(self.fields(file, "wpan", "frame.number")), len(aired))
        self.assertEqual(self.fields(file, "wpan && (_ws.malformed || !(wpan.fcs_ok == 1))", "frame.number"), [])


if __name__ == "__main__":
    unittest.main()
