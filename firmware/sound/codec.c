#include "codec.h"
#include "sounds.h"

#include "../epuck/board.h"
#include "registers.h"

#define LEVEL_CODEC 4 /* below the A/D converter, whose results do not wait */

#define COMMAND_FOLLOWS 0x7FFF /* a sample whose bit 0 asks for a command as the next word */

/* Commands: register in the high byte. */
#define PLL_N1 0x0300     /* N = 1 */
#define PLL_M1 0x0413     /* M = 20: 1.8432 MHz * 20 / 5 / 1024 = 7200 Hz */
#define SPEAKER_ON 0x0118 /* speaker driver and reference powered */
#define GAIN_0_DB 0x075F  /* both speaker outputs active */
#define NOTHING 0x0000

/* The pair of words that the next frame carries. */
static void load(u16 command) {
    TXBUF0 = command == NOTHING ? 0 : COMMAND_FOLLOWS;
    TXBUF1 = command;
}

static void send(u16 command) {
    while (!(DCISTAT & TMPTY)) continue;
    load(command);
}

void INTERRUPT _DCIInterrupt(void) {
    IFS2 &= ~DCIIF;
    (void)RXBUF0;
    TXBUF0 = sounds_sample() & ~1;
}

void codec_start(void) {
    u16 wait;
    LATF &= ~AUDIO_ON;
    TRISF &= ~AUDIO_ON;
    for (wait = 0; wait < 400; ++wait) __asm__ volatile("nop"); /* RESET of the codec: 250 ns at least */
    LATF |= AUDIO_ON;
    DCICON2 = BLEN_2 | COFSG(8) | WS_16; /* 14400 frames/s: each sample is followed by a command */
    DCICON3 = 3; /* bit clock: FCY / 8 */
    TSCON = 1;
    RSCON = 1;
    load(PLL_N1);
    DCICON1 = DCIEN;
    send(PLL_M1);
    send(SPEAKER_ON);
    send(GAIN_0_DB);
    send(NOTHING);
    while (!(DCISTAT & TMPTY)) continue;
    DCICON1 = 0;
    DCICON2 = COFSG(16) | WS_16; /* from now on an interrupt for each sample */
    IFS2 &= ~DCIIF;
    IPC10 = (IPC10 & ~IP_MASK(DCIIP)) | DCIIP(LEVEL_CODEC);
    IEC2 |= DCIIF;
    DCICON1 = DCIEN;
}
