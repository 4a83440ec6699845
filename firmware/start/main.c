/* A firmware for the e-puck's main board to begin with: blinks LED 0 and answers over UART2 (115200 baud, 8N1):
 *   v   its version: "start 1"
 *   t   tenths of a second since power-up: "t 37"
 *   0, 1  LED 1 off, on: "led 0", "led 1"
 *   else "?"
 * Each answer ends with CR LF. */
#include "registers.h"

#define FCY 14745600UL /* cycles a second: 7.3728 MHz, PLL x8, four clocks a cycle */
#define BAUD 115200UL
#define PRESCALER 64
#define TICKS_PER_SECOND 10

volatile unsigned int ticks; /* tenths of a second since power-up */

void INTERRUPT _T1Interrupt(void) {
    IFS0 &= ~T1IF;
    ++ticks;
    if (ticks % 5 == 0) LATA ^= LED0;
}

static void send(char byte) {
    while (U2STA & UTXBF) {
    }
    U2TXREG = (unsigned char)byte;
}

static void send_text(const char *text) {
    while (*text) send(*text++);
}

static void send_number(unsigned int number) {
    char digits[5];
    int count = 0;
    do {
        digits[count++] = (char)('0' + number % 10);
        number /= 10;
    } while (number);
    while (count) send(digits[--count]);
}

static void answer(char command) {
    if (command == 'v') {
        send_text("start 1");
    } else if (command == 't') {
        send_text("t ");
        send_number(ticks);
    } else if (command == '0' || command == '1') {
        if (command == '1')
            LATA |= LED1;
        else
            LATA &= ~LED1;
        send_text("led ");
        send(command);
    } else {
        send('?');
    }
    send_text("\r\n");
}

int main(void) {
    LATA = 0;
    TRISA &= ~(LED0 | LED1);

    PR1 = FCY / PRESCALER / TICKS_PER_SECOND - 1; /* 23040 counts, exact */
    IPC0 = (IPC0 & ~T1IP(7)) | T1IP(3);
    IEC0 |= T1IF;
    T1CON = TON | TCKPS_64;

    U2BRG = FCY / (16 * BAUD) - 1; /* 7: exact */
    U2MODE = UARTEN;
    U2STA = UTXEN;

    for (;;) {
        if (U2STA & OERR) U2STA &= ~OERR; /* a full FIFO stops the receiver for good */
        if (U2STA & URXDA) answer((char)U2RXREG);
    }
}
