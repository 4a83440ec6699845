import sigrokdecode as srd

START, ESCAPE, TURN = 0x7e, 0x7d, 0x20
MOST = 256  # bytes of data: a module sends at most 73 over the air
FRAME, FIELD, WRONG = 0, 2, 4  # annotation classes of RX; those of TX are one higher

# Of each frame type: its name, and its fields in their order: bytes, or None for the rest. Numbers are big-endian.
TYPES = {
    0x08: ('at', (('id', 1), ('command', 2), ('value', None))),
    0x09: ('queued-at', (('id', 1), ('command', 2), ('value', None))),
    0x10: ('tx', (('id', 1), ('to', 8), ('net', 2), ('radius', 1), ('options', 1), ('data', None))),
    0x17: ('remote-at', (('id', 1), ('to', 8), ('net', 2), ('options', 1), ('command', 2), ('value', None))),
    0x88: ('at-response', (('id', 1), ('command', 2), ('status', 1), ('value', None))),
    0x8a: ('modem-status', (('status', 1),)),
    0x8b: ('tx-status', (('id', 1), ('net', 2), ('retries', 1), ('delivery', 1), ('discovery', 1))),
    0x90: ('rx', (('from', 8), ('net', 2), ('options', 1), ('data', None))),
    0x97: ('remote-at-response', (('id', 1), ('from', 8), ('net', 2), ('command', 2), ('status', 1),
                                  ('value', None))),
}


def printed(name, data):
    if name in ('value', 'data'):
        return ' '.join('%02x' % one for one in data)
    if name == 'command':
        return ''.join(chr(one) if 32 < one < 127 else '\\x%02x' % one for one in data)
    return data.hex()


def read(data):
    """The frame's name, and of each field its name, text, first byte and byte after it."""
    name, fields = TYPES.get(data[0], ('other', ()))
    if len(data) - 1 < sum(size or 0 for _, size in fields) or not fields:
        return 'other', [('type', '%02x' % data[0], 0, 1), ('data', printed('data', data[1:]), 1, len(data))]
    found, at = [], 1
    for field, size in fields:
        end = len(data) if size is None else at + size
        found.append((field, printed(field, data[at:end]), at, end))
        at = end
    if at < len(data):  # more than the type has
        return 'other', [('type', '%02x' % data[0], 0, 1), ('data', printed('data', data[1:]), 1, len(data))]
    return name, found


class Line:
    """What came of a frame on one line."""

    def __init__(self):
        self.noise = []  # samples and bytes that are in no frame
        self.begin(None)

    def begin(self, ss):
        self.ss = ss  # None: no frame is under way
        self.escaped, self.head, self.data, self.places = False, [], bytearray(), []


class Decoder(srd.Decoder):
    api_version = 3
    id = 'xbee_api'
    name = 'XBee API'
    longname = 'XBee API frames'
    desc = 'API frames between an XBee module and its host.'
    license = 'mit'
    inputs = ['uart']
    outputs = ['xbee_api']
    tags = ['Embedded/industrial', 'Wireless/RF']
    options = (
        {'id': 'mode', 'desc': 'API mode (AP)', 'default': 2, 'values': (1, 2)},
    )
    annotations = (
        ('rx-frame', 'RX frame'),
        ('tx-frame', 'TX frame'),
        ('rx-field', 'RX field'),
        ('tx-field', 'TX field'),
        ('rx-wrong', 'RX wrong'),
        ('tx-wrong', 'TX wrong'),
    )
    annotation_rows = (
        ('rx-frames', 'RX frames', (0,)),
        ('rx-fields', 'RX fields', (2,)),
        ('rx-errors', 'RX wrong', (4,)),
        ('tx-frames', 'TX frames', (1,)),
        ('tx-fields', 'TX fields', (3,)),
        ('tx-errors', 'TX wrong', (5,)),
    )

    def __init__(self):
        self.reset()

    def reset(self):
        self.lines = (Line(), Line())

    def start(self):
        self.out_ann = self.register(srd.OUTPUT_ANN)
        self.out_python = self.register(srd.OUTPUT_PYTHON)

    def wrong(self, side, ss, es, text):
        self.put(ss, es, self.out_ann, [WRONG + side, [text]])

    def give_noise(self, side):
        line = self.lines[side]
        if line.noise:
            self.wrong(side, line.noise[0][0], line.noise[-1][1],
                       'noise: ' + ' '.join('%02x' % one[2] for one in line.noise))
            line.noise = []

    def decode(self, ss, es, packet):
        kind, side, content = packet
        if kind != 'FRAME':
            return
        line, byte = self.lines[side], content[0] & 0xff
        if not content[1]:
            self.wrong(side, ss, es, 'line error in byte %02x' % byte)
        if byte == START and (self.options['mode'] == 2 or line.ss is None):
            self.give_noise(side)
            if line.ss is not None:
                self.wrong(side, line.ss, ss, 'restart: a start delimiter inside the frame')
            return line.begin(ss)
        if line.ss is None:
            line.noise.append((ss, es, byte))
            return
        if self.options['mode'] == 2 and byte == ESCAPE and not line.escaped:
            line.escaped = True
            return
        if line.escaped:
            byte, line.escaped = byte ^ TURN, False
        self.take(side, line, ss, es, byte)

    def take(self, side, line, ss, es, byte):
        if len(line.head) < 2:
            line.head.append(byte)
            if len(line.head) == 2:
                length = line.head[0] << 8 | line.head[1]
                if length == 0 or length > MOST:
                    self.wrong(side, line.ss, es, 'length: %d bytes' % length)
                    line.begin(None)
            return
        if len(line.data) < (line.head[0] << 8 | line.head[1]):
            line.data.append(byte)
            line.places.append((ss, es))
            return
        begin, data, places = line.ss, bytes(line.data), line.places
        line.begin(None)
        if (sum(data) + byte) & 0xff != 0xff:
            return self.wrong(side, begin, es, 'check: %02x, and the data needs %02x' % (byte, ~sum(data) & 0xff))
        name, fields = read(data)
        text = ' '.join([name] + ['%s %s' % (field, value) for field, value, _, _ in fields if value])
        self.put(begin, es, self.out_ann, [FRAME + side, [text, name]])
        for field, value, first, end in fields:
            if value:
                self.put(places[first][0], places[end - 1][1], self.out_ann,
                         [FIELD + side, ['%s %s' % (field, value), value]])
        self.put(begin, es, self.out_python, ['FRAME', side, data])
