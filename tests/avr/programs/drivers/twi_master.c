/* A register of a two-wire device written, and read back with a repeated START, as util/twi.h names it. */
#include "driver.h"

#include <util/twi.h>

DRIVER

static uint8_t place;

static void go(uint8_t control) {
    TWCR = control | _BV(TWINT) | _BV(TWEN);
    while (!(TWCR & _BV(TWINT)))
        ;
    result[place++] = TW_STATUS;
}
static void send(uint8_t byte) {
    TWDR = byte;
    go(0);
}

int main(void) {
    const uint8_t address = (uint8_t)(input[0] << 1);
    TWBR = 12;
    TWSR = 0;
    go(_BV(TWSTA));
    send(address | TW_WRITE);
    send(input[1]);
    send(input[2]);
    go(_BV(TWSTA));
    send(address | TW_READ);
    go(_BV(TWEA));
    result[32] = TWDR;
    go(0);
    result[33] = TWDR;
    TWCR = _BV(TWINT) | _BV(TWEN) | _BV(TWSTO);
    while (TWCR & _BV(TWSTO))
        ;
    result[34] = TW_STATUS;
    finished();
}
