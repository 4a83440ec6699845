#include "uart.h"

#include "board.h"
#include "registers.h"

#define BAUD 57600UL
#define RING 128 /* a power of two */
#define BRG ((FCY + 2 * BAUD) / (4 * BAUD) - 1)

struct ring {
    u8 bytes[RING];
    volatile u8 in;
    volatile u8 out;
};

static struct ring received[2];
static struct ring to_send[2];

static void put(struct ring* ring, u8 byte) {
    const u8 next = (ring->in + 1) & (RING - 1);
    if (next == ring->out) return;
    ring->bytes[ring->in] = byte;
    ring->in = next;
}

static u16 get(struct ring* ring) {
    u8 byte;
    if (ring->in == ring->out) return UART_NOTHING;
    byte = ring->bytes[ring->out];
    ring->out = (ring->out + 1) & (RING - 1);
    return byte;
}

/* Empties the FIFO; an overrun is cleared, or the UART would stay deaf; bytes with framing errors are
 * dropped. */
#define RECEIVE(STA, RXREG, ring)                                                                            \
    do {                                                                                                     \
        while (STA & URXDA) {                                                                                \
            const u16 bad = STA & FERR;                                                                      \
            const u8 byte = RXREG;                                                                           \
            if (!bad) put(ring, byte);                                                                       \
        }                                                                                                    \
        if (STA & OERR) STA &= ~OERR;                                                                        \
    } while (0)

#define SEND(STA, TXREG, ring)                                                                               \
    while (!(STA & UTXBF) && (ring)->in != (ring)->out)                                                      \
    TXREG = get(ring)

void INTERRUPT _U1RXInterrupt(void) {
    IFS0 &= ~U1RXIF;
    RECEIVE(U1STA, U1RXREG, &received[ROBOT]);
}

void INTERRUPT _U2RXInterrupt(void) {
    IFS1 &= ~U2RXIF;
    RECEIVE(U2STA, U2RXREG, &received[PC]);
}

void INTERRUPT _U1TXInterrupt(void) {
    IFS0 &= ~U1TXIF;
    SEND(U1STA, U1TXREG, &to_send[ROBOT]);
}

void INTERRUPT _U2TXInterrupt(void) {
    IFS1 &= ~U2TXIF;
    SEND(U2STA, U2TXREG, &to_send[PC]);
}

void uart_start(void) {
    U1BRG = BRG;
    U2BRG = BRG;
    U1MODE = UARTEN | BRGH;
    U2MODE = UARTEN | BRGH;
    U1STA = UTXEN;
    U2STA = UTXEN;
    IFS0 &= ~(U1RXIF | U1TXIF);
    IFS1 &= ~(U2RXIF | U2TXIF);
    IPC2 = (IPC2 & ~IP_MASK(U1RXIP)) | U1RXIP(LEVEL_UART);
    IPC3 = (IPC3 & ~IP_MASK(U1TXIP)) | U1TXIP(LEVEL_UART);
    IPC7 = (IPC7 & ~(IP_MASK(U2RXIP) | IP_MASK(U2TXIP))) | U2RXIP(LEVEL_UART) | U2TXIP(LEVEL_UART);
    IEC0 |= U1RXIF | U1TXIF;
    IEC1 |= U2RXIF | U2TXIF;
}

void uart_put(enum uart uart, u8 byte) {
    put(&to_send[uart], byte);
    if (uart == ROBOT) { /* the handler sends */
        IFS0 |= U1TXIF;
    } else {
        IFS1 |= U2TXIF;
    }
}

void uart_text(enum uart uart, const char* text) {
    while (*text != 0)
        uart_put(uart, *text++);
}

u16 uart_get(enum uart uart) {
    return get(&received[uart]);
}
