#include "ircom.h"

#include "analog.h"
#include "board.h"
#include "proximity.h"
#include "registers.h"

#define FIRST_PHOTOTRANSISTOR 8

#define SYMBOLS 12
#define MARK_HALVES 10
#define SPACE_HALVES 5

/* ---- sending ---- */

/* Timer 2 behind 1:8: 261.0 and 521.4 us, as the original. */
#define MARK_COUNTS 481
#define SPACE_COUNTS 961

static volatile u16 symbols; /* those to come, the present one in bit 11 */
static volatile u8 left;     /* symbols to come, the present one included; 0: nothing is sent */
static volatile u8 halves;   /* of the present symbol to come */
static u8 lit;
static volatile u16 last_lit; /* scan in which an emitter was lit, a word's or proximity's */
static u16 last_sent; /* scan in which a word was under way */
static u8 wanted; /* a word waits */
static u8 next_word;

static void emitters(u8 on) {
    if (on) {
        LATG |= PULSE2 | PULSE3;
        LATF |= PULSE0 | PULSE1;
    } else {
        LATG &= ~(PULSE2 | PULSE3);
        LATF &= ~(PULSE0 | PULSE1);
    }
}

static void begin_symbol(void) {
    const u8 space = symbols >> (SYMBOLS - 1) & 1;
    halves = space ? SPACE_HALVES : MARK_HALVES;
    PR2 = (space ? SPACE_COUNTS : MARK_COUNTS) - 1;
}

/* Each half period ends with a toggle, the last one of a word in the dark. */
void INTERRUPT _T2Interrupt(void) {
    IFS0 &= ~T2IF;
    lit = !lit;
    if (--halves == 0) {
        symbols <<= 1;
        if (--left == 0) {
            T2CON = 0;
            lit = 0;
        } else {
            begin_symbol();
        }
    }
    emitters(lit);
}

static u8 check_of(u8 word) {
    u8 ones = 0;
    for (; word; word &= word - 1)
        ++ones;
    return -ones & 3;
}

static void begin_word(void) {
    wanted = 0;
    symbols = (u16)next_word << 2 | check_of(next_word);
    lit = 0;
    begin_symbol();
    TMR2 = 0;
    IFS0 &= ~T2IF;
    left = SYMBOLS;
    T2CON = TON | TCKPS_8;
}

void ircom_send(u8 word) {
    next_word = word;
    wanted = 1;
}

/* ---- receiving: all scans are kept; a word is cut out of them when it is whole ---- */

#define SCANS 256 /* kept, 36.5 ms: a word and what is not known of its beginning */
#define BLOCK 16  /* a beginning is looked for in so many: nine switches of a MARK */
#define BEFORE 12 /* scans that a word can have begun before its first such block */
#define WORD_SCANS (SCANS - 4)
#define WEAKEST 12 /* counts from dark to light */
#define FEWEST 5   /* switches in a block; another robot's proximity pulse has two */
#define CLEAR 12   /* scans of a block beyond the middle half of its range; noise has two or three */
/* In sixteenths of a scan: a symbol between an e-puck's and a TAM's, half a MARK. */
#define SYMBOL 297
#define HALF_MARK 30
#define SPACE_GAP 3 /* scans between two switches */
#define LONGEST_GAP 6
#define FIRST_EDGES 5 /* so many in a row are a word's; fewer may be a proximity pulse just before */
#define REST 16       /* dark scans before and after a word, so that listeners see where it begins and ends */

static volatile s16 scans[SCANS][SENSORS];
static volatile u16 newest; /* scans made, modulo 65536 */
static volatile u8 frozen;  /* the word is whole */
static u16 looked;          /* up to here nothing has begun */
static u16 begin;           /* first scan of the word */
static u8 receiving;
static struct ircom_word word;
static u8 have;

void ircom_scanned(void) {
    volatile s16 *to = scans[newest & (SCANS - 1)];
    const volatile s16 *before = scans[(newest - 1) & (SCANS - 1)];
    const u8 own = proximity_lit(); /* sensors own and own + 4 see their own light */
    u8 i;
    if (own != PROXIMITY_DARK) last_lit = newest;
    if (frozen) return;
    for (i = 0; i < SENSORS; ++i)
        to[i] = (i & 3) == own ? (s16)before[i] : ANALOG(FIRST_PHOTOTRANSISTOR + i);
    if (receiving && newest - begin == WORD_SCANS) frozen = 1;
    ++newest;
}

static s16 at(u16 scan, u8 sensor) {
    return scans[scan & (SCANS - 1)][sensor];
}

/* Range of a sensor in some scans; returns its middle. */
static s16 span(u16 from, u16 count, u8 sensor, s16 *size) {
    s16 low = 4095, high = 0;
    for (; count; --count, ++from) {
        const s16 value = at(from, sensor);
        if (value < low) low = value;
        if (value > high) high = value;
    }
    *size = high - low;
    return (high + low) >> 1;
}

/* Light that is switched, not noise: it goes to and fro, and is hardly ever between. */
static u8 is_switched(u16 from, u8 sensor) {
    s16 size;
    const s16 middle = span(from, BLOCK, sensor, &size);
    u8 found = 0, clear = 0, left_over = BLOCK;
    u8 was = at(from, sensor) < middle;
    if (size < WEAKEST) return 0;
    size >>= 2;
    for (; left_over; --left_over, ++from) {
        const s16 value = at(from, sensor);
        const u8 is = value < middle;
        found += is != was;
        was = is;
        clear += value < middle - size || value > middle + size;
    }
    return found >= FEWEST && clear >= CLEAR;
}

/* Does a word begin in this block? */
static u8 begins(u16 from) {
    u8 sensor;
    for (sensor = 0; sensor < SENSORS; ++sensor)
        if (is_switched(from, sensor)) return 1;
    return 0;
}

/* Each interval between two switches votes for the symbol in whose time its middle lies. 1 if it is a word. */
static u8 read_word(u8 sensor, s16 middle) {
    s16 votes[SYMBOLS];
    u16 bits = 0, first = 0, last = 0, i;
    u8 was = 0, edges = 0;
    for (i = 0; i < WORD_SCANS; ++i) {
        const u8 is = at(begin + i, sensor) < middle;
        if (is == was) continue;
        was = is;
        if (edges == 0 || (edges < FIRST_EDGES && i - last > LONGEST_GAP)) {
            u8 symbol;
            for (symbol = 0; symbol < SYMBOLS; ++symbol)
                votes[symbol] = 0;
            edges = 1;
            first = i;
        } else {
            if (edges < FIRST_EDGES) ++edges;
            const u16 symbol = (8 * (last + i) - 16 * first + HALF_MARK) / SYMBOL;
            if (symbol < SYMBOLS) votes[symbol] += i - last >= SPACE_GAP ? 2 : -1;
        }
        last = i;
    }
    if (edges < FIRST_EDGES) return 0;
    for (i = 0; i < SYMBOLS; ++i) {
        if (votes[i] == 0) return 0;
        bits = bits << 1 | (votes[i] > 0);
    }
    word.data = bits >> 2;
    word.sensor = sensor;
    return bits >> 10 == 0 && (bits & 3) == check_of(word.data);
}

/* From the mean of what is dark to the mean of what is light, so that noise does not count; and an eighth, for the
 * samples that are taken while light comes and goes. */
static s16 strength(u8 sensor, s16 middle) {
    s16 size;
    u32 dark = 0, light = 0;
    u16 darks = 0, lights = 0, i;
    for (i = 0; i < WORD_SCANS; ++i) {
        const s16 value = at(begin + i, sensor);
        if (value < middle) {
            light += value;
            ++lights;
        } else {
            dark += value;
            ++darks;
        }
    }
    /* The processor's own division of 32 by 16 bits: quotients are samples, and fit. */
    if (lights == 0 || darks == 0) return 0;
    size = __builtin_divud(dark, darks) - __builtin_divud(light, lights);
    return size + (size >> 3);
}

/* The brightest sensors first. */
static void read(void) {
    u8 tried = 0, tries;
    for (tries = 0; tries < 3; ++tries) {
        s16 best = WEAKEST - 1, best_middle = 0;
        u8 sensor, best_sensor = SENSORS;
        for (sensor = 0; sensor < SENSORS; ++sensor) {
            s16 size, middle;
            if (tried >> sensor & 1) continue;
            middle = span(begin, WORD_SCANS, sensor, &size);
            if (size > best) {
                best = size;
                best_middle = middle;
                best_sensor = sensor;
            }
        }
        if (best_sensor == SENSORS) return;
        tried |= 1 << best_sensor;
        if (!read_word(best_sensor, best_middle)) continue;
        word.strength = strength(best_sensor, best_middle);
        have = 1;
        return;
    }
}

static void listen_anew(void) {
    looked = newest;
    receiving = 0;
    frozen = 0;
}

void ircom_step(void) {
    if (left) {
        last_lit = last_sent = newest;
        proximity_hold(1);
        listen_anew(); /* own light */
        return;
    }
    if (frozen) {
        read();
        listen_anew();
    }
    if (!receiving && newest - looked >= 2 * SCANS) looked = newest; /* nobody has looked for long */
    while (!receiving && newest - looked >= BLOCK) {
        if (begins(looked)) {
            begin = looked - BEFORE;
            receiving = 1;
        }
        looked += BLOCK;
    }
    proximity_hold(receiving || wanted || newest - last_sent < REST);
    if (wanted && !receiving && proximity_lit() == PROXIMITY_DARK && newest - last_lit >= REST) begin_word();
}

u8 ircom_receive(struct ircom_word *into) {
    if (!have) return 0;
    *into = word;
    have = 0;
    return 1;
}

void ircom_start(void) {
    T2CON = 0;
    IPC1 = (IPC1 & ~IP_MASK(T2IP)) | T2IP(LEVEL_IRCOM);
    IEC0 |= T2IF;
    listen_anew();
}
