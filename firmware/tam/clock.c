#include "clock.h"

#include "registers.h"

#define TICKS_PER_MS 250 /* 16 MHz / 64 */

static volatile u32 now;

INTERRUPT(TIMER0_COMPA) {
    ++now;
}

void clock_start(void) {
    TCCR0A = WGM_CTC;
    OCR0A = TICKS_PER_MS - 1;
    TIMSK0 = OCIEA;
    TCCR0B = CS0_64;
}

u32 clock_ms(void) {
    u32 time;
    const u8 status = SREG;
    CLI();
    time = now;
    SREG = status;
    return time;
}

u8 clock_passed(u32 start, u32 ms) {
    return clock_ms() - start >= ms;
}

void clock_wait(u16 ms) {
    const u32 start = clock_ms();
    while (!clock_passed(start, (u32)ms + 1)) {
        WDR();
        SLEEP();
    }
}
