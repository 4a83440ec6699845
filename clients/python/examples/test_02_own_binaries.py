"""An image and a Linux program of one's own, unmodified: here the project's, given as files."""

import pytest

IMAGE = "epuck.hex"  # a shipped one by its name; yours: a HEX, ELF or COFF file


@pytest.mark.puckloop("own_binaries", duration="44 s", at="41.9 s", images=[{"robot0.pic": IMAGE}],
                      linux=["puckloop-control", "--behaviour", "wander", "--duration", "60"])
def test_the_program_finds_the_firmware_ready(swarm, robot):
    assert swarm.time_s == pytest.approx(41.9)  # the boot was done once, and is skipped from then on
    swarm.step(to="43 s")
    assert "session started" in robot.log
