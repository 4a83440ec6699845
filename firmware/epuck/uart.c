#include "uart.h"

#include "board.h"
#include "clock.h"
#include "registers.h"

#define BAUD 115200UL
#define RING 64 /* a power of two; five actuator records */

static volatile u16 ring[RING];
static volatile u8 ring_in;
static volatile u8 ring_out;
static volatile u16 last_byte;
static const u8* volatile next_out;
static volatile u16 left_out;

static void keep(u16 entry) {
    const u8 next = (ring_in + 1) & (RING - 1);
    if (next == ring_out) return; /* full: the record it belongs to comes out short and is dropped */
    ring[ring_in] = entry;
    ring_in = next;
}

/* Empties the FIFO: a byte that came while this ran must not wait for the next one. */
void INTERRUPT _U2RXInterrupt(void) {
    IFS1 &= ~U2RXIF;
    while (U2STA & URXDA) {
        const u16 error = U2STA & FERR ? UART_BAD : 0; /* belongs to the byte on top */
        keep((U2RXREG & 0xFF) | error);
    }
    if (U2STA & OERR) {
        U2STA &= ~OERR; /* receives again; what was in the FIFO is gone */
        keep(UART_BAD);
    }
    last_byte = clock_ticks();
}

void INTERRUPT _U2TXInterrupt(void) {
    IFS1 &= ~U2TXIF;
    while (left_out != 0 && !(U2STA & UTXBF)) {
        U2TXREG = *next_out++;
        --left_out;
    }
}

void uart_start(void) {
    U2MODE = 0;
    U2STA = 0;
    U2BRG = FCY / (16 * BAUD) - 1; /* 7: exact */
    U2MODE = UARTEN;
    U2STA = UTXISEL | UTXEN; /* interrupt when the transmit FIFO has run empty */
    IFS1 &= ~(U2RXIF | U2TXIF);
    IPC6 = (IPC6 & ~(IP_MASK(U2RXIP) | IP_MASK(U2TXIP))) | U2RXIP(LEVEL_UART) | U2TXIP(LEVEL_UART);
    IEC1 |= U2RXIF | U2TXIF;
}

u16 uart_receive(void) {
    u16 entry;
    if (ring_out == ring_in) return UART_NOTHING;
    entry = ring[ring_out];
    ring_out = (ring_out + 1) & (RING - 1);
    return entry;
}

/* An overrun keeps the receiver from interrupting: the handler has to be sent for. */
void uart_listen(void) {
    if (U2STA & OERR) IFS1 |= U2RXIF;
}

u16 uart_last_byte(void) {
    return last_byte;
}

void uart_send(const u8* bytes, u16 count) {
    next_out = bytes;
    left_out = count;
    IFS1 |= U2TXIF; /* the handler loads the first bytes */
}

u8 uart_sending(void) {
    return left_out != 0;
}
