import struct

import sigrokdecode as srd

COMMAND, REPLY, OTHER, WRONG = range(4)  # annotation classes

# Of each letter: what it is about, and how many parameters its text has.
TEXTS = {
    'A': ('accelerometer', 0), 'B': ('body LED', 1), 'C': ('selector', 0), 'D': ('set speed', 2),
    'E': ('get speed', 0), 'F': ('front LED', 1), 'G': ('infra-red remote', 0), 'H': ('help', 0),
    'I': ('camera parameters', 0), 'J': ('set camera', 4), 'K': ('calibrate proximity', 0), 'L': ('ring LED', 2),
    'M': ('floor sensors', 0), 'N': ('proximity', 0), 'O': ('light', 0), 'P': ('set steps', 2), 'Q': ('steps', 0),
    'R': ('reset', 0), 'S': ('stop', 0), 'T': ('sound', 1), 'U': ('microphones', 0), 'V': ('version', 0),
}
OPTIONAL = ('W', 'X')  # of some builds, with any parameters

# Of each letter in binary: bytes of parameters, format of the reply.
BINARY = {
    'a': (0, '3h'), 'A': (0, '3f'), 'D': (4, ''), 'E': (0, '2h'), 'I': (0, None), 'L': (2, ''), 'M': (0, '3h'),
    'N': (0, '8h'), 'O': (0, '8h'), 'Q': (0, '2h'), 'u': (0, '3h'), 'U': (0, '300h'),
}
PARAMETERS = {'D': '<2h', 'L': '<2B'}
MOST_WORDS = 12  # numbers of a reply that are shown


def words(numbers):
    shown = ' '.join('%.2f' % one if isinstance(one, float) else str(one) for one in numbers[:MOST_WORDS])
    return shown + (' ...' if len(numbers) > MOST_WORDS else '')


class Text:
    def __init__(self):
        self.bytes, self.ss, self.es = bytearray(), None, None

    def add(self, ss, es, byte):
        if self.ss is None:
            self.ss = ss
        self.es = es
        self.bytes.append(byte)


class Decoder(srd.Decoder):
    api_version = 3
    id = 'epuck_btcom'
    name = 'e-puck BTcom'
    longname = 'e-puck BTcom (SerCom) commands'
    desc = 'Commands and replies of the e-puck program BTcom, text and binary.'
    license = 'mit'
    inputs = ['uart']
    outputs = ['epuck_btcom']
    tags = ['Embedded/industrial']
    options = (
        {'id': 'host', 'desc': 'Line that the host sends on', 'default': 'rx', 'values': ('rx', 'tx')},
    )
    annotations = (
        ('command', 'Command'),
        ('reply', 'Reply'),
        ('text', 'Other text of the robot'),
        ('wrong', 'Wrong'),
    )
    annotation_rows = (
        ('commands', 'Commands', (COMMAND,)),
        ('replies', 'Replies', (REPLY, OTHER)),
        ('errors', 'Wrong', (WRONG,)),
    )

    def __init__(self):
        self.reset()

    def reset(self):
        self.command, self.answer = Text(), Text()
        self.letter = None  # of a binary command whose parameters are under way
        self.sequence = []  # letters whose replies come at its end
        self.expected = []  # letters and bytes of binary replies that are due

    def start(self):
        self.out_ann = self.register(srd.OUTPUT_ANN)
        self.out_python = self.register(srd.OUTPUT_PYTHON)
        self.host = 0 if self.options['host'] == 'rx' else 1

    def show(self, text, row, what):
        self.put(text.ss, text.es, self.out_ann, [row, [what]])
        self.put(text.ss, text.es, self.out_python, [('command', 'reply', 'text', 'wrong')[row], bytes(text.bytes)])

    def decode(self, ss, es, packet):
        kind, line, content = packet
        if kind != 'FRAME':
            return
        if not content[1]:
            self.put(ss, es, self.out_ann, [WRONG, ['line error']])
        if line == self.host:
            self.from_host(ss, es, content[0] & 0xff)
        else:
            self.from_robot(ss, es, content[0] & 0xff)

    # What the host sends.
    def from_host(self, ss, es, byte):
        text = self.command
        if self.letter is not None:
            text.add(ss, es, byte)
            if len(text.bytes) == 1 + BINARY[self.letter][0]:
                self.end_binary()
        elif text.ss is None and (byte >= 0x80 or (byte == 0 and self.sequence)):
            text.add(ss, es, byte)
            if byte == 0:
                self.show(text, COMMAND, 'end of the sequence')
                self.expected += [(letter, 1 if letter == 'U' else self.size(letter)) for letter in self.sequence
                                  if letter == 'U' or BINARY[letter][1] != '']
                self.sequence, self.command = [], Text()
            elif chr(256 - byte) in BINARY:
                self.letter = chr(256 - byte)
                if BINARY[self.letter][0] == 0:
                    self.end_binary()
            else:
                self.show(text, WRONG, 'binary %02x: there is no such command' % byte)
                self.command = Text()
        elif byte in b'\r\n':
            if text.ss is not None:
                self.end_text()
        else:
            text.add(ss, es, byte)

    @staticmethod
    def size(letter):
        form = BINARY[letter][1]
        return 3 if form is None else struct.calcsize('<' + form)

    def end_binary(self):
        text, letter = self.command, self.letter
        numbers = struct.unpack(PARAMETERS[letter], bytes(text.bytes[1:])) if letter in PARAMETERS else ()
        about = 'volumes' if letter == 'u' else TEXTS[letter.upper()][0]
        if letter == 'L':
            about = {8: 'body LED', 9: 'front LED'}.get(numbers[0], about)
        self.show(text, COMMAND, ' '.join(['binary', letter, about] + [str(one) for one in numbers]))
        if letter == 'U':
            self.expected.append((letter, self.size(letter)))
        self.sequence.append(letter)
        self.letter, self.command = None, Text()

    def end_text(self):
        text, self.command = self.command, Text()
        said = bytes(text.bytes).decode('latin-1')
        letter, parameters = said[0].upper(), said.split(',')[1:]
        if letter in OPTIONAL:
            return self.show(text, COMMAND, said)
        if letter not in TEXTS:
            return self.show(text, WRONG, '%s: there is no such command' % said)
        about, wanted = TEXTS[letter]
        self.show(text, COMMAND, '%s %s' % (letter, about) + ''.join(' ' + one for one in parameters))
        if len(parameters) != wanted:
            self.show(text, WRONG, '%s: %d parameters, and %s has %d' % (said, len(parameters), letter, wanted))

    # What the robot sends.
    def from_robot(self, ss, es, byte):
        text = self.answer
        if not self.expected:
            if byte in b'\r\n':
                if text.ss is not None:
                    self.end_line()
            else:
                text.add(ss, es, byte)
            return
        text.add(ss, es, byte)
        letter, size = self.expected[0]
        if len(text.bytes) < size:
            return
        if letter == 'I' and len(text.bytes) == 3:
            mode, width, height = text.bytes
            picture = width * height * (1 if mode == 0 else 2)
            if picture:
                self.expected[0] = (letter, 3 + picture)
                return
        self.expected.pop(0)
        self.answer = Text()
        data = bytes(text.bytes)
        if letter == 'I':
            what = 'camera mode %d %dx%d' % tuple(data[:3])
        elif letter == 'U' and size == 1:
            what = 'microphones index %d' % data[0]
        else:
            about = 'volumes' if letter == 'u' else TEXTS[letter.upper()][0]
            what = '%s %s' % (about, words(struct.unpack('<' + BINARY[letter][1], data)))
        self.show(text, REPLY, what)

    def end_line(self):
        text, self.answer = self.answer, Text()
        said = bytes(text.bytes).decode('latin-1')
        letter = said[:1].upper()
        if said.startswith('z,'):
            return self.show(text, WRONG, said)
        if said[:1].islower() and (letter in TEXTS or letter in OPTIONAL) and (len(said) == 1 or said[1] in ', '):
            return self.show(text, REPLY, said)
        shown = ''.join(one if one.isprintable() else '\\x%02x' % ord(one) for one in said)
        self.show(text, OTHER, shown)
