"""PNG pictures as browsers write them (8 bits, no interlacing), and how far two of them are apart."""

import struct
import zlib

BLOCK = 16  #: pixels; letters of another font, and edges of another anti-aliasing, are averaged out


def _unfilter(kind, line, above, width):
    """In place: a line's bytes of the file become those of the picture."""
    for i, value in enumerate(line):
        left = line[i - width] if i >= width else 0
        up = above[i]
        if kind == 1:
            line[i] = (value + left) & 255
        elif kind == 2:
            line[i] = (value + up) & 255
        elif kind == 3:
            line[i] = (value + (left + up) // 2) & 255
        elif kind == 4:
            corner = above[i - width] if i >= width else 0
            guess = left + up - corner
            near = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))
            line[i] = (value + near[2]) & 255


def read(data):
    """Width, height, and lines of bytes, three a pixel."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n", "no PNG"
    at, packed, head = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            head = struct.unpack(">IIBBBBB", data[at + 8:at + 8 + size])
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    width, height, bits, colours, _, _, interlaced = head
    assert bits == 8 and colours in (2, 6) and interlaced == 0, head
    channels = 3 if colours == 2 else 4
    raw, lines, above = zlib.decompress(packed), [], bytearray(width * channels)
    for y in range(height):
        begin = y * (width * channels + 1)
        line = bytearray(raw[begin + 1:begin + 1 + width * channels])
        if raw[begin]:
            _unfilter(raw[begin], line, above, channels)
        above = line
        lines.append(line if channels == 3 else bytes(b for i, b in enumerate(line) if i % 4 != 3))
    return width, height, lines


def _blocks(picture):
    """Means of each block of pixels, by channel."""
    width, height, lines = picture
    means = []
    for y in range(0, height, BLOCK):
        rows = lines[y:y + BLOCK]
        for x in range(0, width, BLOCK):
            end = min(x + BLOCK, width)
            count = (end - x) * len(rows)
            means.append(tuple(sum(sum(row[3 * x + c:3 * end:3]) for row in rows) / count for c in range(3)))
    return means


def apart(one, other):
    """The share of blocks that differ by more than 20 of 255 in a channel; 1: not of one size."""
    first, second = read(one), read(other)
    if first[:2] != second[:2]:
        return 1.0
    pairs = list(zip(_blocks(first), _blocks(second)))
    return sum(max(abs(a - b) for a, b in zip(*pair)) > 20 for pair in pairs) / len(pairs)
