/* PWM of timers 0, 1 and 2 at their pins, capture by timer 3 with the noise canceler, edges at T0. */
#include "driver.h"

DRIVER

static volatile uint8_t captures;

ISR(TIMER3_CAPT_vect) {
    stamps[captures++] = ICR3;
    TCCR3B ^= _BV(ICES3);
    TIFR3 = _BV(ICF3);
}

int main(void) {
    DDRB = _BV(PB3) | _BV(PB4);
    DDRD = _BV(PD5) | _BV(PD7);
    OCR0A = input[0];
    OCR0B = input[1];
    TCCR0A = _BV(COM0A1) | _BV(COM0B1) | _BV(COM0B0) | _BV(WGM01) | _BV(WGM00);
    TCCR0B = _BV(CS00);
    OCR2A = input[2];
    TCCR2A = _BV(COM2A1) | _BV(WGM20);
    TCCR2B = _BV(CS20);
    TCCR1A = _BV(COM1A1) | _BV(WGM11);
    TCCR1B = _BV(WGM13) | _BV(WGM12);
    ICR1 = 1999; /* can be written in such a mode only */
    OCR1A = 500 + input[3];
    TCCR1B |= _BV(CS10);
    TCCR3B = _BV(ICNC3) | _BV(ICES3) | _BV(CS30);
    TIMSK3 = _BV(ICIE3);
    sei();
    while (captures < 6)
        ;
    cli();
    TCCR0A = 0;
    TCCR0B = _BV(CS02) | _BV(CS01) | _BV(CS00);
    TCNT0 = 250;
    TIFR0 = _BV(TOV0);
    GPIOR0 = 1;
    while (!(TIFR0 & _BV(TOV0)))
        ;
    result[0] = TCNT0;
    finished();
}
