// A project around a firmware of the main board.

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "base/files/text_file.h"
#include "tools/guide/project/new_files.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

// NAME in each text is the project's name.

constexpr std::string_view kFirmwareScenario = R"(#:schema ./scenario.schema.json
# The firmware on an e-puck: a program of the Linux board speaks to it, and what it has to do is below.
#   puckloop run NAME.toml --in-process
#   puckloop debug firmware/firmware.elf      # without the robot: break, step, print

[run]
seed = 1
duration = "10 s" # at most: the run ends when the program does

[arena]
size = ["1 m", "1 m"]

[[robot]]
name = "robot0"
position = ["0 m", "0 m"]

[robot.pic]
firmware = "firmware/firmware.elf" # the ELF has the names of variables and lines

[robot.linux]
program = ["./talk.py"]
start = "1 s"

[[expect]]
name = "it states its version"
link = "robot0.uart" # UART2 and the Linux board
from = "robot0.pic"
bytes = "73 74 61 72 74 20 31 0D 0A" # "start 1"
by = "2 s"

[[expect]]
name = "its clock runs"
board = "robot0.pic"
holds = "ticks >= 15" # a variable of main.c
by = "1600 ms"

[[expect]]
name = "LED 1 is lit"
board = "robot0.pic"
holds = "0x2C4:1 >= 0x80" # LATA, bit 7

[[expect]]
no_loss = "robot0.uart"

[[expect]]
no_reset = "robot0.pic"

[[expect]]
log = "robot0.linux"
text = "done"
)";

constexpr std::string_view kTalk = R"(#!/usr/bin/python3
"""Speaks to the firmware by the Linux board's serial line, on the robot as here; docs/linux-programs.md of puckloop."""

import os
import select
import termios
import time
import tty


def ask(port: int, command: str) -> str:
    """The firmware's answer, a line."""
    os.write(port, command.encode())
    line = b""
    while not line.endswith(b"\r\n"):
        if not select.select([port], [], [], 2)[0]:
            raise SystemExit(f"no answer to {command!r}: {line!r} has come")
        line += os.read(port, 100)
    return line.decode().strip()


def main() -> None:
    port = os.open("/dev/ttyS0", os.O_RDWR | os.O_NOCTTY)
    tty.setraw(port)
    settings = termios.tcgetattr(port)
    settings[4] = settings[5] = termios.B115200
    termios.tcsetattr(port, termios.TCSAFLUSH, settings)
    print(ask(port, "v"))
    print(ask(port, "1"))
    first = int(ask(port, "t").split()[1])
    time.sleep(2)
    print("after two seconds", int(ask(port, "t").split()[1]) - first, "ticks more")
    print("done")


if __name__ == "__main__":
    main()
)";

constexpr std::string_view kFirmwareTest =
    R"("""The firmware, driven step by step: needs python3-puckloop (`import puckloop`).

Simulated time stands still between two calls; what a test sees is the same in each run.
"""

import pathlib
import unittest

import puckloop

HERE = pathlib.Path(__file__).resolve().parent


class Firmware(unittest.TestCase):
    def setUp(self) -> None:
        self.run_ = puckloop.start(HERE / "NAME.toml")
        self.addCleanup(self.run_.close)
        self.board = self.run_.board("robot0.pic")
        self.answers = self.run_.dut("robot0.uart", "robot0.pic")
        self.run_.step(to="500 ms")  # the Linux board's program begins at 1 s

    def ask(self, command: str, answer: str) -> None:
        self.run_.type("robot0.uart", "robot0.linux", command)
        self.answers.expect(answer + "\r\n", timeout="20 ms")

    def test_it_answers(self) -> None:
        self.ask("v", "start 1")
        self.ask("x", "?")

    def test_the_led_is_switched(self) -> None:
        self.ask("1", "led 1")
        self.assertEqual(self.board.register("LATA").value & 0x80, 0x80)
        self.ask("0", "led 0")
        self.assertEqual(self.board.register("LATA").value & 0x80, 0)

    def test_the_clock_is_exact(self) -> None:
        before = self.board.variable("ticks", 2).value
        self.run_.step(for_="300 ms")
        self.assertEqual(self.board.variable("ticks", 2).value - before, 3)

    def test_it_goes_on_after_too_many_bytes(self) -> None:
        self.run_.type("robot0.uart", "robot0.linux", "t" * 12)  # its answers are slower: the FIFO overruns
        self.run_.step(for_="50 ms")
        self.answers = self.run_.dut("robot0.uart", "robot0.pic")
        self.ask("v", "start 1")


if __name__ == "__main__":
    unittest.main()
)";

constexpr std::string_view kFirmwareMakefile =
    R"(# make firmware PIC30_PREFIX=/opt/microchip/xc16/v1.26/bin/xc16-
.PHONY: firmware check test
firmware:
	$(MAKE) -C firmware
check:
	puckloop check NAME.toml
test:
	puckloop run NAME.toml --in-process
	python3 -m unittest -v
)";

constexpr std::string_view kFirmwareReadme = R"(# NAME

A firmware for the e-puck's main board, which puckloop runs without the robot.

* `firmware`: sources and the built image; `make firmware PIC30_PREFIX=.../xc16-` builds it with XC16
* `NAME.toml`: the robot around it, and what a run has to do (`[[expect]]`)
* `talk.py`: the Linux board's program, as on the robot
* `test_NAME.py`: looks into the chip step by step, by python3-puckloop
* `ci`: how CI gets puckloop; `.github`, `.gitlab-ci.yml`: what it does then

Begin with

    puckloop run NAME.toml --in-process
    python3 -m unittest -v
    puckloop debug firmware/firmware.elf

XC16 is not in Debian: commit the image with its sources, so that CI tests it as it is. Another image, HEX, ELF or
COFF, is one line in `NAME.toml`; a HEX has no variables.

`puckloop help run` has the options; the documents are in /usr/share/doc/puckloop/docs or in `docs` of
puckloop's sources: expect.md, debugger.md, python.md, debugging.md (what is warned of, and why).
)";

}  // namespace

std::vector<NewFile> firmware_files(std::string_view name) {
    const std::string file(name);
    std::vector<NewFile> files{{file + ".toml", named(kFirmwareScenario, name)},
                               {"README.md", named(kFirmwareReadme, name)},
                               {"talk.py", std::string(kTalk), true},
                               {"Makefile", named(kFirmwareMakefile, name)},
                               {"test_" + file + ".py", named(kFirmwareTest, name)}};
    for (const char* part :
         {"main.c", "registers.h", "crt0.s", "start.ld", "Makefile", "firmware.elf", "firmware.hex"}) {
        const std::string shipped = fmt::format("firmware/start/{}", part);
        const std::filesystem::path from = shipped_file(shipped);
        const std::optional<std::string> text = from.empty() ? std::nullopt : read_whole_file(from);
        if (!text)
            throw RunError(fmt::format("{} is not installed: the package puckloop-firmware has it", shipped));
        files.push_back({fmt::format("firmware/{}", part), *text});
    }
    add_shared_files(files, name, "${workspaceFolder}/firmware/firmware.elf");
    return files;
}

}  // namespace puckloop::tools
