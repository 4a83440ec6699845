/* A lamp that blinks every 100 us: the program that docs/debugging.md debugs. */

#include <avr/interrupt.h>
#include <avr/io.h>

volatile unsigned int ticks;
unsigned char levels[4];
unsigned char boots __attribute__((section(".noinit")));

ISR(TIMER1_COMPA_vect) {
    ticks++;
}

static __attribute__((noinline)) unsigned char brightness(unsigned int now) {
    return now % 7 * 3;
}

static __attribute__((noinline)) void remember(unsigned char level) {
    for (unsigned char i = 3; i > 0; i--)
        levels[i] = levels[i - 1];
    levels[0] = level;
}

static __attribute__((noinline)) void never(void) {
    PORTB = 0;
}

int main(void) {
    unsigned int seen = 0;
    boots++;
    DDRB = 1;
    OCR1A = 1599;
    TCCR1B = _BV(WGM12) | _BV(CS10);
    TIMSK1 = _BV(OCIE1A);
    sei();
    for (;;) {
        if (ticks == seen) continue;
        seen = ticks;
        remember(brightness(seen));
        PORTB ^= 1;
        if (seen == 60000) never();
    }
}
