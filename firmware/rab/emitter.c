#include "emitter.h"

#include "board.h"
#include "frames.h"
#include "receiver.h"
#include "registers.h"
#include "sampler.h"

/* After a frame, own or heard, the air stays free for so many chips: boards with the original firmware are
 * blind for 25 chips after a frame. */
#define FREE_AIR 27
#define BACK_OFF 0x1F     /* and for so many more at random, so that two that wait do not start together */
#define LONGEST_WAIT 102  /* chips, 10 ms; then the frame goes out anyway */
#define LFSR_TAPS 0xB400U /* x^16 + x^14 + x^13 + x^11 + 1 */

static const struct frame* frame; /* on the air */
static const u16* ones;           /* the bit that is next or half sent */
static u16 next_chip;             /* gates */
static u8 chip;                   /* of the frame, the next one */
static u8 chips;
static u8 silence; /* chips since the last light or own frame */
static u8 waited;
static u16 lottery;

static void wait_for_air(void) {
    if (sampler_lit() & ~receiver_dazzled()) {
        silence = 0;
    } else if (silence != 0xFF) {
        ++silence;
    }
    lottery = lottery & 1 ? (lottery >> 1) ^ LFSR_TAPS : lottery >> 1;
    frame = frames_next();
    if (frame == 0) return;
    if (silence != 0xFF && silence < FREE_AIR + (lottery & BACK_OFF) && waited != LONGEST_WAIT) {
        ++waited;
        frame = 0;
    }
}

void INTERRUPT _T1Interrupt(void) {
    IFS0 &= ~T1IF;
    LATB = (LATB & ~EMITTERS) | next_chip;
    next_chip = 0;
    if (frame == 0) {
        wait_for_air();
        if (frame == 0) return;
        frames_begin();
        waited = 0;
        chip = 0;
        chips = PREAMBLE_CHIPS + 2 * (frame->bits + CHECK_BITS);
        ones = frame->ones;
    }
    if (chip == chips) { /* the last one has just begun */
        frame = 0;
        silence = 0;
        frames_done();
        return;
    }
    if (chip < PREAMBLE_CHIPS) {
        next_chip = frame->armed;
    } else if (!(chip & 1)) { /* a 1 is on, off; a 0 off, on */
        next_chip = *ones;
    } else {
        next_chip = frame->armed ^ *ones++;
    }
    ++chip;
}

void emitter_start(u16 seed) {
    LATB = CHIP_SELECT;
    TRISB = ~(EMITTERS | CHIP_SELECT);
    LATF |= EMITTER_SUPPLY;
    TRISF &= ~EMITTER_SUPPLY;
    lottery = seed | 1;
    silence = 0xFF;
    TMR2 = 0;
    PR2 = CARRIER_CYCLES - 1;
    OC1RS = CARRIER_CYCLES / 2;
    OC1R = CARRIER_CYCLES / 2;
    OC1CON = OCM_PWM;
    T2CON = TON;
    TMR1 = 0;
    PR1 = CHIP_CYCLES - 1;
    IFS0 &= ~T1IF;
    IPC0 = (IPC0 & ~IP_MASK(T1IP)) | T1IP(LEVEL_CHIP);
    IEC0 |= T1IF;
    T1CON = TON;
}
