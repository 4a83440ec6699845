#include "uart.h"

#include "board.h"
#include "registers.h"

#define UNITS 2
#define SIZE 128 /* a power of two */
#define MASK (SIZE - 1)

/* Rates: the console 57 600 (58 824 by the divider, 2.1 % fast), the radio 9600 (9615). */
#define UBRR_CONSOLE 16
#define UBRR_RADIO_U2X 207

struct ring {
    u8 bytes[SIZE];
    volatile u8 head; /* next to be filled */
    volatile u8 tail; /* next to be taken */
};

static struct ring in[UNITS], out[UNITS];
static volatile u8 broken[UNITS];

static void received(u8 unit) {
    const u8 status = UCSRA(unit);
    const u8 byte = UDR(unit);
    struct ring *ring = &in[unit];
    const u8 next = (ring->head + 1) & MASK;
    if (status & (FE | DOR)) broken[unit] = 1;
    if (status & FE) return;
    if (next == ring->tail) {
        broken[unit] = 1;
        return;
    }
    ring->bytes[ring->head] = byte;
    ring->head = next;
}

static void sendable(u8 unit) {
    struct ring *ring = &out[unit];
    if (ring->head == ring->tail) {
        UCSRB(unit) &= ~UDRIE;
        return;
    }
    UDR(unit) = ring->bytes[ring->tail];
    ring->tail = (ring->tail + 1) & MASK;
}

INTERRUPT(USART0_RX) {
    received(CONSOLE);
}
INTERRUPT(USART0_UDRE) {
    sendable(CONSOLE);
}
INTERRUPT(USART1_RX) {
    received(RADIO);
}
INTERRUPT(USART1_UDRE) {
    sendable(RADIO);
}

void uart_start(void) {
    u8 unit;
    UBRR(CONSOLE) = UBRR_CONSOLE;
    UBRR(RADIO) = UBRR_RADIO_U2X;
    UCSRA(RADIO) = U2X;
    for (unit = 0; unit < UNITS; ++unit) {
        UCSRC(unit) = UCSZ_8;
        UCSRB(unit) = RXCIE | RXEN | TXEN;
    }
}

void uart_send(u8 unit, u8 byte) {
    struct ring *ring = &out[unit];
    const u8 next = (ring->head + 1) & MASK;
    u8 status;
    while (next == ring->tail)
        SLEEP(); /* at most 1.04 ms until the next byte is gone */
    ring->bytes[ring->head] = byte;
    ring->head = next;
    status = SREG;
    CLI();
    UCSRB(unit) |= UDRIE;
    SREG = status;
}

u8 uart_receive(u8 unit, u8 *byte) {
    struct ring *ring = &in[unit];
    if (ring->head == ring->tail) return 0;
    *byte = ring->bytes[ring->tail];
    ring->tail = (ring->tail + 1) & MASK;
    return 1;
}

u8 uart_broken(u8 unit) {
    const u8 was = broken[unit];
    broken[unit] = 0;
    return was;
}

void print(const char *text) {
    for (; *text; ++text)
        uart_send(CONSOLE, (u8)*text);
}

void print_number(u16 number) {
    char digits[6];
    u8 at = sizeof digits - 1;
    digits[at] = 0;
    do {
        digits[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number);
    print(&digits[at]);
}
