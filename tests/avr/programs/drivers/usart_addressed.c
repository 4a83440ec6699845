/* Multi-processor mode with nine bits: frames without the mark are not seen until the address is ours. */
#include "driver.h"

DRIVER

int main(void) {
    uint8_t n = 0;
    UBRR0 = 16;
    UCSR0A = _BV(MPCM0);
    UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(UCSZ02);
    for (;;) {
        while (!(UCSR0A & _BV(RXC0)))
            ;
        const uint8_t mark = UCSR0B & _BV(RXB80);
        const uint8_t byte = UDR0;
        result[n++] = byte;
        if (mark) UCSR0A = byte == input[0] ? 0 : _BV(MPCM0);
    }
}
