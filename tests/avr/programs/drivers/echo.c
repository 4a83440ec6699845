/* USART1 by interrupts through a ring, double speed, even parity, two stop bits. */
#include "driver.h"

DRIVER

static volatile uint8_t ring[16], head, tail, bad;

ISR(USART1_RX_vect) {
    const uint8_t errors = UCSR1A & (_BV(FE1) | _BV(DOR1) | _BV(UPE1));
    const uint8_t byte = UDR1;
    if (errors)
        result[bad++] = errors;
    else
        ring[head++ & 15] = byte;
    UCSR1B |= _BV(UDRIE1);
}
ISR(USART1_UDRE_vect) {
    if (head == tail)
        UCSR1B &= ~_BV(UDRIE1);
    else
        UDR1 = ring[tail++ & 15] ^ 0xFF;
}

int main(void) {
    UCSR1A = _BV(U2X1);
    UBRR1 = 16;
    UCSR1C = _BV(UPM11) | _BV(USBS1) | _BV(UCSZ11) | _BV(UCSZ10);
    UCSR1B = _BV(RXCIE1) | _BV(RXEN1) | _BV(TXEN1);
    sei();
    for (;;)
        ;
}
