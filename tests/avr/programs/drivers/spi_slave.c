/* SPI slave that answers each byte with the one before it, inverted. */
#include "driver.h"

DRIVER

static volatile uint8_t count;

ISR(SPI_STC_vect) {
    const uint8_t byte = SPDR;
    SPDR = (uint8_t)~byte;
    result[count++] = byte;
}

int main(void) {
    DDRB = _BV(PB6);
    SPCR = _BV(SPIE) | _BV(SPE) | (input[0] & (_BV(DORD) | _BV(CPOL) | _BV(CPHA)));
    SPDR = input[1];
    sei();
    for (;;)
        ;
}
