/* Conversions started by timer 1's compare B, without its interrupt; channel and reference that change under
   way; the comparator on the ADC's multiplexer; a conversion that sleeping starts. */
#include "driver.h"

#include <avr/sleep.h>

DRIVER

static volatile uint8_t conversions, crossings;
static volatile uint16_t last;

ISR(ADC_vect) {
    PINA = _BV(PA7);
    last = ADC;
    TIFR1 = _BV(OCF1B); /* the next edge of the flag starts the next one */
    ++conversions;
}
ISR(ANALOG_COMP_vect) {
    ++crossings;
}

int main(void) {
    DDRA = _BV(PA7);
    OCR1A = 9999;
    OCR1B = 5000;
    TCCR1B = _BV(WGM12) | _BV(CS10);
    ADMUX = _BV(REFS0) | 3;
    ADCSRB = _BV(ADTS2) | _BV(ADTS0);
    ADCSRA = _BV(ADEN) | _BV(ADATE) | _BV(ADIE) | 5; /* /32 */
    sei();
    while (conversions < 5)
        ;
    cli();
    stamps[0] = last;
    /* The channel stays the one with which the conversion began. */
    ADCSRA = _BV(ADEN) | 7;
    ADMUX = _BV(REFS0) | 1;
    ADCSRA |= _BV(ADSC);
    for (volatile uint8_t n = 0; n < 20; ++n)
        ;
    ADMUX = _BV(REFS0) | 2;
    while (ADCSRA & _BV(ADSC))
        ;
    stamps[1] = ADC;
    /* Noise reduction mode starts one by itself, and its end wakes. */
    conversions = 0;
    ADCSRA = _BV(ADEN) | _BV(ADIF) | _BV(ADIE) | 7;
    set_sleep_mode(SLEEP_MODE_ADC);
    sei();
    sleep_mode();
    stamps[2] = last;
    result[0] = conversions;
    /* The comparator's negative input is ADC4, its positive one the bandgap. */
    ADCSRA = 0;
    ADCSRB = _BV(ACME);
    ADMUX = 4;
    ACSR = _BV(ACBG);
    ACSR = _BV(ACBG) | _BV(ACI);
    ACSR = _BV(ACBG) | _BV(ACIE);
    result[1] = crossings;
    GPIOR0 = 1;
    while (crossings < 3)
        ;
    result[2] = ACSR;
    finished();
}
