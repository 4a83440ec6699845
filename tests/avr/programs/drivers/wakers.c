/* Pin changes on every port wake from power-down; JTAG gives its pins back only when asked twice. */
#include "driver.h"

#include <avr/sleep.h>

DRIVER

static volatile uint8_t woken;

ISR(PCINT0_vect) {
    woken |= 1;
}
ISR(PCINT1_vect) {
    woken |= 2;
}
ISR(PCINT2_vect) {
    woken |= 4;
}
ISR(PCINT3_vect) {
    woken |= 8;
}

int main(void) {
    DDRC = _BV(PC3);
    PORTC = _BV(PC3);
    __asm__ __volatile__("nop");
    result[0] = PINC;
    MCUCR = _BV(JTD);
    __asm__ __volatile__("nop\n nop\n nop\n nop\n nop\n");
    result[1] = PINC;
    MCUCR |= _BV(JTD);
    MCUCR |= _BV(JTD);
    __asm__ __volatile__("nop");
    result[2] = PINC;
    DIDR0 = 0x0F;
    __asm__ __volatile__("nop");
    result[3] = PINA;
    DIDR0 = 0;
    PCMSK0 = input[0];
    PCMSK1 = input[1];
    PCMSK2 = input[2];
    PCMSK3 = input[3];
    PCICR = 0x0F;
    set_sleep_mode(SLEEP_MODE_PWR_DOWN);
    sei();
    for (uint8_t i = 0; i < 4; ++i) {
        GPIOR0 = i + 1;
        sleep_mode();
        result[4 + i] = woken;
        woken = 0;
    }
    finished();
}
