"""The records between the e-puck's Linux board and its main board (docs/sigrok.md). Stack it on uart.

115,200 bit/s, 8N1, little-endian, without header and check: a session of 5 bytes (wake-up, configuration) and
actuators of 12 bytes from Linux, sensors of 72 bytes from the main board. Synchronisation is by count alone, so the
decoder counts as the main board does: what is left over when the other side answers is marked as out of step.
"""

from .pd import Decoder
