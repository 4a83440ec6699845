/* INT0 to INT2 by edges and level, and who comes first. */
#include "driver.h"

DRIVER

static volatile uint8_t count;

ISR(INT0_vect) {
    result[count++] = 0x10;
}
ISR(INT1_vect) {
    result[count++] = 0x11;
}
ISR(INT2_vect) {
    result[count++] = 0x12;
    EIMSK &= ~_BV(INT2); /* a level: once is enough */
}

int main(void) {
    EICRA = _BV(ISC01) | _BV(ISC11) | _BV(ISC10); /* INT0 falling, INT1 rising, INT2 low level */
    EIMSK = _BV(INT0) | _BV(INT1) | _BV(INT2);
    GPIOR0 = 1; /* the test moves all three pins now; the flags wait */
    for (volatile uint8_t n = 0; n < 100; ++n)
        ;
    sei();
    while (count < 4)
        ;
    finished();
}
