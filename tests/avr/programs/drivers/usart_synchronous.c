/* USART0 in synchronous mode, master or slave of XCK0 as drawn: sends what was drawn, keeps what comes. */
#include "driver.h"

DRIVER

static volatile uint8_t received, sent;

ISR(USART0_RX_vect) {
    const uint8_t errors = UCSR0A & (_BV(FE0) | _BV(DOR0) | _BV(UPE0));
    result[16 + received] = errors;
    result[received++] = UDR0;
}
ISR(USART0_UDRE_vect) {
    UDR0 = input[4 + sent++];
    if (sent == 8) UCSR0B &= ~_BV(UDRIE0);
}

int main(void) {
    if (input[0]) DDRB = _BV(PB0);
    UBRR0 = input[1];
    UCSR0C = _BV(UMSEL00) | (input[2] & (_BV(UPM01) | _BV(UPM00) | _BV(USBS0) | _BV(UCPOL0))) | _BV(UCSZ01) |
             _BV(UCSZ00);
    UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0) | _BV(UDRIE0);
    sei();
    for (;;)
        ;
}
