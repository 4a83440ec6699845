"""Infra-red frames of the e-puck's range-and-bearing board, as light at an emitter or a demodulator (docs/sigrok.md).

Chips of 98.085 us, 1 is carrier: six chips of 1, then payload of 8, 16, 24 or 32 bits, least significant first, and a
check of 4 bits, most significant first, which makes the ones of the payload and the check 0 mod 16. A bit is 10 if it
is set, 01 if not. Nothing marks the end: four chips without light do.
"""

from .pd import Decoder
