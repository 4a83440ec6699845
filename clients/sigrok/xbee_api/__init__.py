"""API frames of XBee modules (docs/sigrok.md). Stack it on uart; both lines are read.

7E, length (two bytes, high first), frame data, check (FF minus the sum of the data); with API mode 2 the bytes 7E, 7D,
11 and 13 after the start delimiter are sent as 7D and the byte exclusive-or 20.
"""

from .pd import Decoder
