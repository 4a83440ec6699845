"""A TAM and its coordinator find each other in the mesh."""


def test_the_tam_reports_to_its_coordinator(puckloop_start):
    run = puckloop_start("tam_visit")
    run.capture(link="tam0.xbee", sender="tam0.avr")
    step = run.step(to="5 s", until={"frame": {"link": "coordinator.uart", "from": "coordinator.xbee", "value": "90"}})
    assert step.met  # a byte of an API frame "received"
    assert bytes(frame.byte for frame in run.frames()).startswith(b"\x7e\x00\x06\x08\x01ID")  # it asks its network
