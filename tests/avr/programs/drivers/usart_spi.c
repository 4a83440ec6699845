/* USART1 as SPI master: the data sheet's order of steps, bytes back to back. */
#include "driver.h"

DRIVER

int main(void) {
    UBRR1 = 0;
    DDRD |= _BV(PD4);
    UCSR1C = _BV(UMSEL11) | _BV(UMSEL10) | (input[0] & 7);
    UCSR1B = _BV(RXEN1) | _BV(TXEN1);
    UBRR1 = input[1];
    DDRA = _BV(PA0);
    PORTA = _BV(PA0); /* from here the slave listens */
    uint8_t out = 0, in = 0;
    while (in < 8) {
        if (out < 8 && (UCSR1A & _BV(UDRE1))) UDR1 = input[2 + out++];
        if (UCSR1A & _BV(RXC1)) result[in++] = UDR1;
    }
    while (!(UCSR1A & _BV(TXC1)))
        ;
    result[8] = UCSR1A;
    finished();
}
