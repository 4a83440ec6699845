import math
import struct

import sigrokdecode as srd

SESSION, ACTUATORS, SENSORS = range(3)
LINUX_FIELD, BOARD_FIELD, WRONG = 3, 4, 5  # annotation classes after those of the records
ADC_MOST = 4095  # 12 bits
LONGEST_PAUSE_S = 0.02  # within a sensor record; the board was reset where it lasts longer

# Of each record: name, struct format of one number, how many.
FIELDS = {
    SESSION: (('wake_up', 'B', 1), ('rab_range', 'B', 1), ('rab_enabled', 'B', 1), ('padding', 'H', 1)),
    ACTUATORS: (('left', 'h', 1), ('right', 'h', 1), ('rab_data', 'H', 1), ('ring_leds', 'B', 1),
                ('other_leds', 'B', 1), ('ircom_enabled', 'B', 1), ('ircom_data', 'B', 1), ('reset', 'B', 1),
                ('padding', 'B', 1)),
    SENSORS: (('rab_data', 'H', 1), ('rab_range', 'H', 1), ('rab_bearing', 'f', 1), ('proximity', 'h', 8),
              ('battery_ok', 'H', 1), ('accelerometer', 'h', 3), ('microphones', 'h', 4), ('light', 'h', 8),
              ('rab_received', 'H', 1), ('ircom_received', 'H', 1), ('ircom_data', 'B', 1), ('padding', 'B', 1),
              ('ircom_sensor', 'H', 1), ('ircom_range', 'f', 1), ('ircom_bearing', 'f', 1)),
}
NAMES = {SESSION: 'session', ACTUATORS: 'actuators', SENSORS: 'sensors'}
SIZES = {record: sum(struct.calcsize(code) * count for _, code, count in fields)
         for record, fields in FIELDS.items()}


def read(record, data):
    """Name, value, first byte and byte after it of each field; a value is a number or a tuple of numbers."""
    at = 0
    for name, code, count in FIELDS[record]:
        end = at + struct.calcsize(code) * count
        values = struct.unpack('<%d%s' % (count, code), data[at:end])
        yield name, values[0] if count == 1 else values, at, end
        at = end


def words(value):
    if isinstance(value, tuple):
        return ' '.join(words(one) for one in value)
    return '%.3f' % value if isinstance(value, float) else str(value)


def text_of(record, it):
    if record == SESSION:
        return 'session wake-up %02x rab_range %d rab_enabled %d' % (it['wake_up'], it['rab_range'], it['rab_enabled'])
    if record == ACTUATORS:
        reset = chr(it['reset']) if 32 <= it['reset'] < 127 else '%02x' % it['reset']
        return 'actuators left %d right %d ring %02x leds %x rab %04x ircom %d:%02x reset %s' % (
            it['left'], it['right'], it['ring_leds'], it['other_leds'], it['rab_data'], it['ircom_enabled'],
            it['ircom_data'], reset)
    text = 'sensors proximity %s light %s accelerometer %s microphones %s battery %s' % (
        words(it['proximity']), words(it['light']), words(it['accelerometer']), words(it['microphones']),
        'ok' if it['battery_ok'] else 'low')
    if it['rab_received']:
        text += ' rab %04x range %d bearing %.3f' % (it['rab_data'], it['rab_range'], it['rab_bearing'])
    if it['ircom_received']:
        text += ' ircom %02x sensor %d range %.1f bearing %.3f' % (
            it['ircom_data'], it['ircom_sensor'], it['ircom_range'], it['ircom_bearing'])
    return text


def why_wrong(record, it):
    """What no main board or Linux program sends; empty: nothing."""
    if record == ACTUATORS and it['reset'] not in b'NR':
        return 'reset is %02x, neither N nor R' % it['reset']
    if record != SENSORS:
        return ''
    for name, low, high in (('padding', 0, 0), ('battery_ok', 0, 1), ('proximity', -ADC_MOST, ADC_MOST),
                            ('light', 0, ADC_MOST), ('accelerometer', -ADC_MOST, ADC_MOST),
                            ('microphones', -ADC_MOST, ADC_MOST), ('rab_received', 0, 1), ('ircom_received', 0, 1),
                            ('ircom_sensor', 0, 7)):
        values = it[name] if isinstance(it[name], tuple) else (it[name],)
        if not all(low <= value <= high for value in values):
            return 'implausible: %s is outside %d..%d' % (name, low, high)
    for name in ('rab_bearing', 'ircom_range', 'ircom_bearing'):
        if not math.isfinite(it[name]):
            return 'implausible: %s is not a number' % name
    return ''


class Run:
    """Bytes of one side that are no whole record yet, each with its samples."""

    def __init__(self):
        self.bytes, self.places, self.wrong = bytearray(), [], []

    def take(self):
        taken = Run()
        taken.bytes, taken.places, taken.wrong = self.bytes, self.places, self.wrong
        self.__init__()
        return taken


class Decoder(srd.Decoder):
    api_version = 3
    id = 'epuck_record'
    name = 'e-puck record'
    longname = 'e-puck records between Linux and main board'
    desc = 'Session, actuator and sensor records of the e-puck.'
    license = 'mit'
    inputs = ['uart']
    outputs = ['epuck_record']
    tags = ['Embedded/industrial']
    options = (
        {'id': 'linux', 'desc': 'Line that Linux sends on', 'default': 'rx', 'values': ('rx', 'tx')},
    )
    annotations = (
        ('session', 'Session'),
        ('actuators', 'Actuators'),
        ('sensors', 'Sensors'),
        ('linux-field', 'Field from Linux'),
        ('board-field', 'Field from the main board'),
        ('wrong', 'Wrong'),
    )
    annotation_rows = (
        ('linux', 'From Linux', (SESSION, ACTUATORS)),
        ('linux-fields', 'Fields from Linux', (LINUX_FIELD,)),
        ('board', 'From the main board', (SENSORS,)),
        ('board-fields', 'Fields from the main board', (BOARD_FIELD,)),
        ('wrong', 'Wrong', (WRONG,)),
    )

    def __init__(self):
        self.reset()

    def reset(self):
        self.samplerate = None
        self.linux, self.board = Run(), Run()
        self.expected = SESSION

    def metadata(self, key, value):
        if key == srd.SRD_CONF_SAMPLERATE:
            self.samplerate = value

    def start(self):
        self.out_ann = self.register(srd.OUTPUT_ANN)
        self.out_python = self.register(srd.OUTPUT_PYTHON)
        self.linux_line = 0 if self.options['linux'] == 'rx' else 1

    def decode(self, ss, es, packet):
        kind, line, content = packet
        if kind != 'FRAME':
            return
        value, valid = content
        from_linux = line == self.linux_line
        if not from_linux and self.linux.bytes:
            self.give_rest(self.linux, '%d bytes left when the main board answered: out of step'
                           % len(self.linux.bytes))
            self.expected = ACTUATORS
        if not from_linux and self.board.bytes and self.samplerate and \
                ss - self.board.places[-1][1] > LONGEST_PAUSE_S * self.samplerate:
            self.give_rest(self.board, '%d of 72 bytes, then silence' % len(self.board.bytes))
        run = self.linux if from_linux else self.board
        run.bytes.append(value & 0xff)
        run.places.append((ss, es))
        if not valid:
            run.wrong.append((ss, es, 'byte %d (%02x): line error' % (len(run.bytes), value & 0xff)))
        if from_linux:
            if len(run.bytes) >= SIZES[self.expected]:
                it = self.give(self.expected, run)
                if self.expected == SESSION:
                    self.expected = ACTUATORS
                else:
                    if it['reset'] == ord('R'):
                        self.expected = SESSION
                    self.give_rest(self.board, '%d of 72 bytes when Linux sent its next record'
                                   % len(self.board.bytes))
        elif len(run.bytes) >= SIZES[SENSORS]:
            self.give(SENSORS, run)

    def give(self, record, run):
        run = run.take()
        ss, es = run.places[0][0], run.places[-1][1]
        it = {}
        field = BOARD_FIELD if record == SENSORS else LINUX_FIELD
        for name, value, first, end in read(record, bytes(run.bytes)):
            it[name] = value
            if name != 'padding':
                self.put(run.places[first][0], run.places[end - 1][1], self.out_ann,
                         [field, ['%s %s' % (name, words(value)), words(value)]])
        self.put(ss, es, self.out_ann, [record, [text_of(record, it), NAMES[record]]])
        for one in run.wrong:
            self.put(one[0], one[1], self.out_ann, [WRONG, [one[2]]])
        why = why_wrong(record, it)
        if why:
            self.put(ss, es, self.out_ann, [WRONG, [why]])
        self.put(ss, es, self.out_python, [NAMES[record], it])
        return it

    def give_rest(self, run, what):
        if not run.bytes:
            return
        run = run.take()
        self.put(run.places[0][0], run.places[-1][1], self.out_ann,
                 [WRONG, ['%s: %s' % (what, ' '.join('%02x' % one for one in run.bytes)), what]])
