#include "sampler.h"

#include "registers.h"

#define RING 64          /* a power of two; changes come at most twice a chip from each sender */
#define RECEIVER_TICKS 4 /* the receiver looks at the changes and at what has become due so often */

static struct change ring[RING];
static volatile u8 ring_in;
static volatile u8 ring_out;
static volatile u8 lost;
static volatile u16 tick;
static volatile u16 lit;
static u8 countdown;

void INTERRUPT _T3Interrupt(void) {
    const u16 now = ~PORTD & (ALL_SENSORS << FIRST_DEMODULATOR);
    IFS0 &= ~T3IF;
    ++tick;
    if (now != lit) {
        const u8 next = (ring_in + 1) & (RING - 1);
        lit = now;
        ring[ring_in].tick = tick;
        ring[ring_in].lit = now;
        if (next == ring_out) {
            lost = 1;
        } else {
            ring_in = next;
        }
    }
    if (countdown-- == 0) {
        countdown = RECEIVER_TICKS - 1;
        IFS1 |= INT1IF;
    }
}

void sampler_start(void) {
    TMR3 = 0;
    PR3 = TICK_CYCLES - 1;
    IFS0 &= ~T3IF;
    IPC2 = (IPC2 & ~IP_MASK(T3IP)) | T3IP(LEVEL_SAMPLE);
    IEC0 |= T3IF;
    T3CON = TON;
}

u16 sampler_tick(void) {
    return tick;
}

u16 sampler_lit(void) {
    return lit >> FIRST_DEMODULATOR;
}

u8 sampler_take(struct change* change) {
    if (ring_out == ring_in) return 0;
    change->tick = ring[ring_out].tick;
    change->lit = ring[ring_out].lit >> FIRST_DEMODULATOR;
    ring_out = (ring_out + 1) & (RING - 1);
    return 1;
}

u8 sampler_overrun(void) {
    const u8 was = lost;
    lost = 0;
    return was;
}
