"""BTcom (SerCom), the e-puck's commands on UART1 and Bluetooth, 115,200 bit/s 8N1 (docs/sigrok.md). Stack it on uart.

Texts: a letter and parameters after commas, to a CR or LF; replies are lines that begin with the small letter.
Binary: bytes from 80 on are 256 minus a letter, each with a fixed number of parameter bytes; 00 ends the sequence, and
the replies come after it in the same order, little-endian. Only U is answered at once.
"""

from .pd import Decoder
