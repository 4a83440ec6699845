/* A master that is pulled low at SS, and finds itself a slave. */
#include "driver.h"

DRIVER

ISR(SPI_STC_vect) {
    result[0] = SPCR;
    result[1] = SPSR;
    DDRB = 0;
    finished();
}

int main(void) {
    DDRB = _BV(PB5) | _BV(PB7);
    SPCR = _BV(SPE) | _BV(MSTR) | _BV(SPIE);
    sei();
    result[2] = SPCR;
    for (;;)
        ;
}
