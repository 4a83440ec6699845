#include "ircom.h"

#include "board.h"
#include "clock.h"
#include "registers.h"

#define SYMBOLS 12
#define MARK_HALVES 10
#define SPACE_HALVES 5
/* Timer 2, 4 us. */
#define MARK_TICKS 65
#define SPACE_TICKS 130
/* Timer 1, 0.5 us. */
#define SYMBOL_TICKS 5200u
#define WORD_TICKS (SYMBOLS * SYMBOL_TICKS) /* 62400: fits 16 bits */
#define SHORTEST_TICKS 260u                 /* half a MARK's half period: noise */
#define LONG_TICKS 780u                     /* between a MARK's and a SPACE's */
#define LONGEST_TICKS 2000u                 /* no edge for so long: not within a word */
#define WORD_MS 34
#define FEWEST_EDGES 20 /* a word has 60 and more; fewer are a robot that measures proximity */

static u8 check_of(u8 word) {
    u8 ones = 0;
    for (; word; word &= word - 1)
        ++ones;
    return (u8)(-ones) & 3;
}

/* ---- sending: each half period ends with an edge, made by timer 2's compare interrupt; the last in the dark ---- */

static volatile u16 symbols; /* those to come, the next one in bit 11 */
static volatile u8 left;     /* symbols to come, the present one included */
static volatile u8 halves;   /* of the present symbol to come */

static void begin_symbol(void) {
    const u8 space = symbols >> (SYMBOLS - 1) & 1;
    halves = space ? SPACE_HALVES : MARK_HALVES;
    OCR2A = (space ? SPACE_TICKS : MARK_TICKS) - 1;
}

INTERRUPT(TIMER2_COMPA) {
    if (--halves == 0) {
        symbols <<= 1;
        if (--left == 0) {
            PORTB &= ~PROX_EMIT;
            TIMSK2 = 0;
            TCCR2B = 0;
            return;
        }
        begin_symbol();
    }
    PORTB ^= PROX_EMIT;
}

u8 ircom_send(u8 word) {
    if (left) return 0;
    symbols = (u16)word << 2 | check_of(word);
    left = SYMBOLS;
    begin_symbol();
    TCNT2 = 0;
    TIFR2 = OCIEA;
    TIMSK2 = OCIEA;
    TCCR2B = CS2_64;
    return 1;
}

u8 ircom_sending(void) {
    return left != 0;
}

/* ---- receiving: each gap between two edges votes for the symbol in whose time its middle lies ---- */

static volatile u8 running;       /* a word has begun */
static volatile u8 seen;          /* and has been under way since begun_ms */
static volatile u8 edges;         /* of it, at most 255 */
static volatile u16 first, last;  /* times of its first and its newest edge */
static volatile s8 votes[SYMBOLS]; /* > 0: SPACE */
static u32 begun_ms;
static u16 errors;

INTERRUPT(TIMER1_CAPT) {
    const u16 now = ICR1;
    const u16 gap = now - last;
    TCCR1B ^= ICES1; /* the other edge next; this may set the flag */
    TIFR1 = ICF1;
    if (left) {
        running = 0;
        return;
    }
    if (!running || gap > LONGEST_TICKS) {
        u8 i;
        if (running && edges >= FEWEST_EDGES) return; /* a word that is not read yet */
        for (i = 0; i < SYMBOLS; ++i)
            votes[i] = 0;
        running = edges = 1;
        seen = 0;
        first = last = now;
        return;
    }
    if (edges < 255) ++edges;
    if (gap >= SHORTEST_TICKS) {
        const u16 symbol = (last - first + gap / 2) / SYMBOL_TICKS;
        if (symbol < SYMBOLS) votes[symbol] += gap > LONG_TICKS ? 2 : -1;
    }
    last = now;
}

void ircom_start(void) {
    TCCR2A = WGM_CTC;
    TCCR1B = ICNC1 | ICES1 | CS1_8;
    TIMSK1 = ICIE1;
}

u8 ircom_receive(u8 *word) {
    u16 bits = 0;
    u8 found;
    u8 i;
    if (!running) {
        seen = 0;
        return 0;
    }
    if (!seen) {
        begun_ms = clock_ms();
        seen = 1; /* until a flash that was no word makes room for the next */
        return 0;
    }
    if (!clock_passed(begun_ms, WORD_MS)) return 0;
    CLI();
    for (i = 0; i < SYMBOLS; ++i)
        bits = bits << 1 | (votes[i] > 0);
    found = edges;
    running = seen = 0;
    TCCR1B |= ICES1;
    TIFR1 = ICF1;
    SEI();
    *word = (u8)(bits >> 2);
    if (bits >> 10 || (bits & 3) != check_of(*word)) {
        if (found >= FEWEST_EDGES) ++errors;
        return 0;
    }
    return 1;
}

u16 ircom_errors(void) {
    return errors;
}
