"""The shipped scenario of the network: who hears whom, and one trace in both placements."""

import json
import pathlib
import tempfile
import unittest

from kit import SOURCE, puckloop


class Network(unittest.TestCase):
    def test_everybody_hears_everybody(self):
        traces = []
        with tempfile.TemporaryDirectory() as place:
            for name, options in (("one", ["--in-process"]), ("own", [])):
                out = pathlib.Path(place) / name
                done = puckloop("run", SOURCE / "scenarios/network.toml", *options, "--out", out)
                self.assertEqual(done.returncode, 0, done.stderr)
                traces.append(json.loads((out / "report.json").read_text())["trace_sha256"])
                for listener in ("alice", "bob", "server"):
                    heard = (out / f"{listener}.linux.log").read_text()
                    for speaker in ("alice", "bob", "server"):
                        self.assertIn(f"hello 3 from {speaker}\n", heard, listener)
            decoded = puckloop("trace", "decode", out, "--protocol", "ip")
            self.assertIn("alice.network alice.linux ip: UDP 10.0.0.1:5000 > 255.255.255.255:5000", decoded.stdout)
        self.assertEqual(traces[0], traces[1])


if __name__ == "__main__":
    unittest.main()
