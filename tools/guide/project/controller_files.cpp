// A project around a controller: a program of the Linux board.

#include "tools/guide/project/new_files.h"

namespace puckloop::tools {

namespace {

// NAME in each text is the project's name.

constexpr std::string_view kScenario = R"(#:schema ./scenario.schema.json
# One e-puck drives until something is in its way, and turns.
#   puckloop check NAME.toml
#   puckloop run NAME.toml --in-process

[run]
seed = 1
duration = "60 s" # at most: the run ends when the controller does, after 20 s

[arena]
size = ["1.2 m", "90 cm"]

[[box]]
name = "carton"
centre = ["30 cm", "15 cm"]
size = ["15 cm", "10 cm", "10 cm"]

[[robot]]
name = "robot0"
position = ["-10 cm", "0 cm"]
heading = "30 deg"

[robot.pic]
firmware = "own" # or your image: "my_firmware.hex", relative to this file

[robot.linux]
program = ["./controller.py"] # or "./controller", which `make` builds from controller.c
start = "1 s"

# The run fails where this does not happen: a controller that waits for the robot for ever, say.
[[expect]]
log = "robot0.linux"
text = "done"
)";

constexpr std::string_view kPython = R"(#!/usr/bin/python3
"""Drives an e-puck by its serial line, on the robot as here (puckloop: docs/linux-programs.md, docs/framing.md).

The robot sends records of 72 bytes: accelerometer from 0, then from 8 eight proximity sensors, clockwise from front
right, 16 bits each, little-endian, ... It takes 12 bytes: both wheels' speeds in motor steps/s, ..., the order ("N": go
on, "R": end of the session).
"""

import os
import select
import struct
import termios
import time
import tty

CYCLES = 190  # of 100 ms


def read_exactly(port: int, count: int) -> bytes:
    data = b""
    while len(data) < count:
        if not select.select([port], [], [], 5)[0]:
            raise SystemExit(f"the robot is silent: {len(data)} bytes of {count} have come")
        data += os.read(port, count - len(data))
    return data


def main() -> None:
    port = os.open("/dev/ttyS0", os.O_RDWR | os.O_NOCTTY)
    tty.setraw(port)
    settings = termios.tcgetattr(port)
    settings[4] = settings[5] = termios.B115200
    termios.tcsetattr(port, termios.TCSAFLUSH, settings)
    os.write(port, bytes([1, 0, 0, 0, 0]))  # wake-up and configuration
    sensors = read_exactly(port, 72)
    for _ in range(CYCLES):
        proximity = struct.unpack_from("<8h", sensors, 8)
        blocked = max(proximity[0], proximity[7]) > 300
        left, right = (-200, 200) if blocked else (400, 400)  # motor steps/s
        os.write(port, struct.pack("<hhHBBBBBB", left, right, 0, 0, 0, 0, 0, ord("N"), 0))
        sensors = read_exactly(port, 72)
        time.sleep(0.1)
    os.write(port, struct.pack("<hhHBBBBBB", 0, 0, 0, 0, 0, 0, 0, ord("R"), 0))  # end of the session
    print("done")


if __name__ == "__main__":
    main()
)";

constexpr std::string_view kC =
    R"(/* The same as controller.py: drives until something is in the way, and turns. */
#include <fcntl.h>
#include <poll.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

static void read_exactly(int port, uint8_t *data, size_t count) {
    while (count > 0) {
        struct pollfd ready = {port, POLLIN, 0};
        if (poll(&ready, 1, 5000) <= 0) {
            fprintf(stderr, "the robot is silent: %zu bytes have not come\n", count);
            _exit(1);
        }
        ssize_t got = read(port, data, count);
        if (got <= 0) _exit(1);
        data += got;
        count -= (size_t)got;
    }
}

static void send(int port, int16_t left, int16_t right, uint8_t order) {
    uint8_t actuators[12] = {0};
    memcpy(actuators, &left, 2);
    memcpy(actuators + 2, &right, 2);
    actuators[10] = order;
    if (write(port, actuators, sizeof actuators) != sizeof actuators) _exit(1);
}

int main(void) {
    int port = open("/dev/ttyS0", O_RDWR | O_NOCTTY);
    if (port < 0) return 1;
    struct termios settings;
    tcgetattr(port, &settings);
    cfmakeraw(&settings);
    cfsetspeed(&settings, B115200);
    tcsetattr(port, TCSAFLUSH, &settings);
    const uint8_t hello[5] = {1, 0, 0, 0, 0}; /* wake-up and configuration */
    if (write(port, hello, sizeof hello) != sizeof hello) return 1;
    uint8_t sensors[72];
    read_exactly(port, sensors, sizeof sensors);
    for (int cycle = 0; cycle < 190; ++cycle) {
        int16_t proximity[8];
        memcpy(proximity, sensors + 8, sizeof proximity);
        int blocked = proximity[0] > 300 || proximity[7] > 300;
        send(port, blocked ? -200 : 400, blocked ? 200 : 400, 'N');
        read_exactly(port, sensors, sizeof sensors);
        usleep(100000);
    }
    send(port, 0, 0, 'R'); /* end of the session */
    puts("done");
    return 0;
}
)";

constexpr std::string_view kMakefile = R"(CFLAGS ?= -O2 -Wall -Wextra

controller: controller.c

.PHONY: check test
check:
	puckloop check NAME.toml
test:
	python3 -m unittest -v
)";

constexpr std::string_view kTest =
    R"("""What the robot has to do. Run with `python3 -m unittest` or pytest; PUCKLOOP names another program."""

import csv
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
PUCKLOOP = os.environ.get("PUCKLOOP", "puckloop")


class Drive(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.folder = tempfile.TemporaryDirectory()
        cls.out = pathlib.Path(cls.folder.name)
        cls.run_ = subprocess.run(
            [PUCKLOOP, "run", HERE / "NAME.toml", "--in-process", "--out", cls.out],
            capture_output=True, text=True, check=False, timeout=300)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.folder.cleanup()

    def test_the_run_succeeds(self) -> None:
        self.assertEqual(self.run_.returncode, 0, self.run_.stdout + self.run_.stderr)
        report = json.loads((self.out / "report.json").read_text())
        self.assertTrue(report["success"])
        self.assertEqual(report["warnings"], [])

    def test_the_controller_ends_its_session(self) -> None:
        self.assertIn("done", (self.out / "robot0.linux.log").read_text())

    def test_the_robot_moves(self) -> None:
        with open(self.out / "trajectory.csv", newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["robot"] == "robot0"]
        first, last = rows[0], rows[-1]
        moved = max(abs(float(row["x_m"]) - float(first["x_m"])) for row in rows)
        self.assertGreater(moved, 0.1, f"from {first} to {last}")


if __name__ == "__main__":
    unittest.main()
)";

constexpr std::string_view kReadme = R"(# NAME

An e-puck that puckloop runs without the robot.

* `NAME.toml`: arena, robot, what the run has to do
* `controller.py`, `controller.c`: the Linux board's program, as on the robot
* `test_NAME.py`: looks at a run's results
* `ci`: how CI gets puckloop; `.github`, `.gitlab-ci.yml`: what it does then

Begin with

    puckloop check NAME.toml
    puckloop run NAME.toml --in-process --view     # with the page; Ctrl-C ends it
    python3 -m unittest -v                         # or: make test

`puckloop help run` has the options; the documents are in /usr/share/doc/puckloop/docs or in `docs` of
puckloop's sources: scenario.md (keys), linux-programs.md, framing.md (what goes over the line), expect.md.
)";

}  // namespace

std::vector<NewFile> controller_files(std::string_view name) {
    const std::string file(name);
    std::vector<NewFile> files{
        {file + ".toml", named(kScenario, name)},      {"README.md", named(kReadme, name)},
        {"controller.py", std::string(kPython), true}, {"controller.c", std::string(kC)},
        {"Makefile", named(kMakefile, name)},          {"test_" + file + ".py", named(kTest, name)}};
    add_shared_files(files, name, "${workspaceFolder}/my_firmware.elf");
    return files;
}

}  // namespace puckloop::tools
