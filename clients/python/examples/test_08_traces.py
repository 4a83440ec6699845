"""A run's trace, decoded and for Wireshark."""

import json
import subprocess

import puckloop


def test_records_are_decoded(puckloop_start, tmp_path):
    run = puckloop_start("hello", duration="3 s")
    run.step(to="2 s")
    run.end()
    words = [puckloop.program(), "trace", "decode", str(run.results), "--protocol", "epuck", "--json"]
    records = [json.loads(line) for line in subprocess.run(words, capture_output=True, check=True).stdout.splitlines()]
    assert records[0]["record"] == "session"
    assert any(record["record"] == "actuators" and record["left"] > 0 for record in records)
    file = tmp_path / "run.pcapng"
    subprocess.run([puckloop.program(), "trace", "export", str(run.results), "-o", str(file)], check=True)
    assert file.read_bytes()[:4] == b"\x0a\x0d\x0d\x0a"
