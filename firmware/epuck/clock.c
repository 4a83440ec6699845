#include "clock.h"

#include "board.h"
#include "registers.h"

static volatile u16 ticks;

void INTERRUPT _T1Interrupt(void) {
    IFS0 &= ~T1IF;
    ++ticks;
}

void clock_start(void) {
    TMR1 = 0;
    PR1 = FCY / TICKS_PER_SECOND - 1; /* 14400 cycles, exact */
    IPC0 = (IPC0 & ~IP_MASK(T1IP)) | T1IP(LEVEL_CLOCK);
    IEC0 |= T1IF;
    T1CON = TON;
}

u16 clock_ticks(void) {
    return ticks;
}
