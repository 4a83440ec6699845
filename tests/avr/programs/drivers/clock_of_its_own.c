/* Timer 2 on a watch crystal: update flags, ticks in power-save, stopped in power-down. */
#include "driver.h"

#include <avr/sleep.h>

DRIVER

static volatile uint8_t ticks, pin_changes;

ISR(TIMER2_COMPA_vect) {
    PINA = _BV(PA0);
    ++ticks;
}
ISR(PCINT1_vect) {
    ++pin_changes;
}

static void wait_for(uint8_t flags) {
    while (ASSR & flags)
        ;
}

int main(void) {
    DDRA = _BV(PA0);
    TCCR1B = _BV(CS10);
    ASSR = _BV(AS2);
    OCR2A = input[0];
    OCR2B = 7;
    TCCR2A = _BV(WGM21);
    TCCR2B = _BV(CS21); /* /8 */
    result[0] = ASSR;
    result[1] = OCR2A; /* reads as written, before it is taken */
    result[2] = TCCR2B;
    TCNT1 = 0;
    OCR2B = 9;
    wait_for(_BV(OCR2BUB));
    stamps[0] = TCNT1;
    wait_for(_BV(TCN2UB) | _BV(OCR2AUB) | _BV(OCR2BUB) | _BV(TCR2AUB) | _BV(TCR2BUB));
    result[3] = ASSR;
    TIFR2 = 0xFF;
    TIMSK2 = _BV(OCIE2A);
    set_sleep_mode(SLEEP_MODE_PWR_SAVE);
    sei();
    while (ticks < 6)
        sleep_mode();
    result[4] = ticks;
    /* In power-down only the pin wakes, and the timer has stood still meanwhile. */
    PCMSK1 = _BV(PCINT8);
    PCICR = _BV(PCIE1);
    OCR2B = 1;
    wait_for(_BV(OCR2BUB));
    result[5] = TCNT2;
    result[6] = ticks;
    set_sleep_mode(SLEEP_MODE_PWR_DOWN);
    sleep_mode();
    result[7] = TCNT2;
    result[8] = ticks;
    result[9] = pin_changes;
    finished();
}
