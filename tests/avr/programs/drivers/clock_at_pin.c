/* Timer 2 counting the edges of a signal at TOSC1, through its prescaler. */
#include "driver.h"

DRIVER

int main(void) {
    ASSR = _BV(EXCLK);
    ASSR |= _BV(AS2);
    TCNT2 = 100;
    TCCR2B = _BV(CS21);
    while (ASSR & (_BV(TCN2UB) | _BV(TCR2BUB)))
        ;
    GPIOR0 = 1;
    while (GPIOR0 == 1)
        result[0] = TCNT2;
    finished();
}
