import sigrokdecode as srd

PREAMBLE, CHECK_BITS = 6, 4
SIZES = (8, 16, 24, 32)  # bits of payload
LENGTHS = {PREAMBLE + 2 * (size + CHECK_BITS): size for size in SIZES}  # by chips
END = 4  # chips without light: Manchester has at most two alike
MOST_CHIPS = 200
FRAME, BIT, PART, WRONG = range(4)  # annotation classes


class SamplerateError(Exception):
    pass


def check_of(payload):
    return -bin(payload).count('1') % 16


def read(chips, size=0):
    """Payload and its size of a frame as text of 0 and 1, and what is wrong: (payload, size, check, wrong)."""
    size = size or LENGTHS.get(len(chips), 0)
    for chip in range(min(PREAMBLE, len(chips))):
        if chips[chip] == '0':
            return 0, size, 0, 'preamble: chip %d is off' % chip
    bits = []
    for chip in range(PREAMBLE, len(chips) - 1, 2):
        if chips[chip] == chips[chip + 1]:
            return 0, size, 0, 'manchester: chips %d and %d are equal' % (chip, chip + 1)
        bits.append(int(chips[chip]))
    if not size or len(chips) != PREAMBLE + 2 * (size + CHECK_BITS):
        return 0, size, 0, 'length: %d chips, and frames have %s' % (
            len(chips), PREAMBLE + 2 * (size + CHECK_BITS) if size else '30, 46, 62 or 78')
    payload = sum(bit << place for place, bit in enumerate(bits[:size]))
    check = int(''.join(str(bit) for bit in bits[size:]), 2)
    if check != check_of(payload):
        return payload, size, check, 'check: %x, and payload %0*x needs %x' % (
            check, size // 4, payload, check_of(payload))
    return payload, size, check, ''


class Decoder(srd.Decoder):
    api_version = 3
    id = 'epuck_rab'
    name = 'e-puck RAB'
    longname = 'e-puck range and bearing, infra-red'
    desc = 'Infra-red frames of the e-puck range-and-bearing board.'
    license = 'mit'
    inputs = ['logic']
    outputs = ['epuck_rab']
    tags = ['IR', 'Embedded/industrial']
    channels = (
        {'id': 'ir', 'name': 'IR', 'desc': 'Light: an emitter or a demodulator'},
    )
    options = (
        {'id': 'polarity', 'desc': 'Level while there is light', 'default': 'active-high',
            'values': ('active-high', 'active-low')},
        {'id': 'bits', 'desc': 'Bits of payload (0: by the length)', 'default': 0, 'values': (0,) + SIZES},
        {'id': 'chip_us', 'desc': 'Chip (us)', 'default': 98.085},
    )
    annotations = (
        ('frame', 'Frame'),
        ('bit', 'Bit'),
        ('part', 'Part'),
        ('wrong', 'Wrong'),
    )
    annotation_rows = (
        ('bits', 'Bits', (BIT,)),
        ('parts', 'Parts', (PART,)),
        ('frames', 'Frames', (FRAME,)),
        ('errors', 'Wrong', (WRONG,)),
    )

    def __init__(self):
        self.reset()

    def reset(self):
        self.samplerate = None

    def metadata(self, key, value):
        if key == srd.SRD_CONF_SAMPLERATE:
            self.samplerate = value

    def start(self):
        self.out_ann = self.register(srd.OUTPUT_ANN)
        self.out_python = self.register(srd.OUTPUT_PYTHON)

    def decode(self):
        if not self.samplerate:
            raise SamplerateError('Cannot decode without samplerate.')
        self.chip = self.options['chip_us'] * 1e-6 * self.samplerate
        lit = 1 if self.options['polarity'] == 'active-high' else 0
        on, off = ('r', 'f') if lit else ('f', 'r')
        silence = int(END * self.chip)
        (level,) = self.wait({'skip': 0})
        if level == lit:  # in the middle of something
            self.wait({0: off})
        while True:
            self.wait({0: on})
            begin = edge = self.samplenum
            chips, edges = '', [begin]
            while True:
                # Light ends, or goes on for longer than any frame's.
                self.wait({0: off})
                chips += self.counted(edge, '1')
                edge = self.samplenum
                edges.append(edge)
                self.wait([{0: on}, {'skip': silence}])
                if not self.matched[0]:
                    break
                chips += self.counted(edge, '0')
                edge = self.samplenum
                edges.append(edge)
            self.give(begin, edge, chips[:MOST_CHIPS])

    def counted(self, since, mark):
        return mark * max(0, min(8, int((self.samplenum - since) / self.chip + 0.5)))

    def give(self, begin, end, chips):
        if len(chips) % 2:  # a last chip that is off is silence
            chips += '0'
            end = max(end, int(begin + len(chips) * self.chip))
        payload, size, check, wrong = read(chips, self.options['bits'])
        at = lambda chip: int(begin + (end - begin) * chip / len(chips))
        if not chips:
            return self.put(begin, end, self.out_ann, [WRONG, ['a glitch', 'glitch']])
        if wrong:
            self.put(begin, end, self.out_ann, [WRONG, ['%s (chips %s)' % (wrong, chips), wrong]])
            return
        self.put(begin, at(PREAMBLE), self.out_ann, [PART, ['preamble', 'P']])
        for bit in range(size + CHECK_BITS):
            chip = PREAMBLE + 2 * bit
            self.put(at(chip), at(chip + 2), self.out_ann, [BIT, [chips[chip]]])
        after = PREAMBLE + 2 * size
        self.put(at(PREAMBLE), at(after), self.out_ann,
                 [PART, ['payload %0*x' % (size // 4, payload), '%0*x' % (size // 4, payload)]])
        self.put(at(after), end, self.out_ann, [PART, ['check %x' % check, '%x' % check]])
        self.put(begin, end, self.out_ann,
                 [FRAME, ['payload %0*x check %x' % (size // 4, payload, check), '%0*x' % (size // 4, payload)]])
        self.put(begin, end, self.out_python, [payload, size])
