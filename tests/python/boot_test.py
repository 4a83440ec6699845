"""A test after a boot of 40 s: it goes on from a snapshot within a second.

Processor time is bounded, as the machine may be busy; on an idle one the wall clock shows no more.
"""

import os
import pathlib
import time
import unittest

from kit import SOURCE, InFolder

import puckloop

TURNS = 3


def processor_seconds():
    """Of this process and of those that it waited for."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


class Boot(InFolder):
    def after(self, **keywords):
        """Processor seconds of a run that goes on at 40 s, does a millisecond and is closed."""
        begun = time.monotonic()
        with puckloop.start(SOURCE / "scenarios" / "own_binaries.toml", out=self.folder / "boot", **keywords) as run:
            run.step(to="40 s")
            program_counter = run.board("robot0.pic").register("PC")
            snapshot = run.save(self.folder / "run.snapshot")
        boot = time.monotonic() - begun
        processor, wall = [], []
        for turn in range(TURNS):
            begun, used = time.monotonic(), processor_seconds()
            with puckloop.Run.from_snapshot(snapshot, out=self.folder / f"after{turn}") as run:
                self.assertEqual(run.time_ps, 40_000_000_000_000)
                self.assertEqual(run.board("robot0.pic").register("PC"), program_counter)
                run.step(for_="1 ms")
                wall.append(time.monotonic() - begun)
            processor.append(processor_seconds() - used)
        print(f"boot {boot:.2f} s; after it {min(wall):.3f} s, {min(processor):.3f} s of processor time", flush=True)
        return min(processor)

    def test_own_firmware(self):
        self.assertLess(self.after(), 1.0)

    def test_the_original_firmware(self):
        image = pathlib.Path(os.environ.get("PUCKLOOP_IMAGES", "/nonexistent")) / "epuck_firmware.hex"
        if not image.is_file():
            self.skipTest("PUCKLOOP_IMAGES has no epuck_firmware.hex")
        self.assertLess(self.after(firmware={"robot0.pic": image}), 1.0)


if __name__ == "__main__":
    unittest.main()
