/* SPI master: mode, order and rate as drawn; SS as output selects the slave. */
#include "driver.h"

DRIVER

int main(void) {
    PORTB = _BV(PB4);
    DDRB = _BV(PB4) | _BV(PB5) | _BV(PB7);
    SPCR = _BV(SPE) | _BV(MSTR) | (input[0] & (_BV(DORD) | _BV(CPOL) | _BV(CPHA))) | 2; /* /64 */
    for (uint8_t i = 0; i < 8; ++i) {
        PORTB &= ~_BV(PB4);
        SPDR = input[1 + i];
        while (!(SPSR & _BV(SPIF)))
            ;
        result[i] = SPDR;
        PORTB |= _BV(PB4);
        for (volatile uint8_t n = 0; n < 60; ++n)
            ;
    }
    /* Busy: a second byte does not get in. */
    PORTB &= ~_BV(PB4);
    SPDR = 0x55;
    SPDR = 0xAA;
    result[8] = SPSR & _BV(WCOL);
    while (!(SPSR & _BV(SPIF)))
        ;
    result[9] = SPDR;
    result[10] = SPSR;
    PORTB |= _BV(PB4);
    finished();
}
