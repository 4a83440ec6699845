/* A register file as two-wire slave, by interrupts, as the data sheet's tables have it. */
#include "driver.h"

#include <util/twi.h>

DRIVER

static uint8_t place, first;
static volatile uint8_t count;

ISR(TWI_vect) {
    const uint8_t status = TW_STATUS;
    if (count < 40) result[16 + count++] = status;
    switch (status) {
    case TW_SR_SLA_ACK:
    case TW_SR_ARB_LOST_SLA_ACK:
        first = 1;
        break;
    case TW_SR_DATA_ACK:
        if (first)
            place = TWDR & 15;
        else
            result[place++ & 15] = TWDR;
        first = 0;
        break;
    case TW_ST_SLA_ACK:
    case TW_ST_ARB_LOST_SLA_ACK:
    case TW_ST_DATA_ACK:
        TWDR = result[place++ & 15];
        break;
    default:
        break;
    }
    TWCR = _BV(TWINT) | _BV(TWEA) | _BV(TWEN) | _BV(TWIE);
}

int main(void) {
    TWAR = (uint8_t)(input[0] << 1);
    TWCR = _BV(TWEA) | _BV(TWEN) | _BV(TWIE);
    sei();
    for (;;)
        ;
}
