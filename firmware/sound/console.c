#include "console.h"

#include "../epuck/board.h"
#include "registers.h"

#define BAUD 115200UL
#define RING 64 /* a power of two */

static volatile char ring[RING];
static volatile u8 ring_in;
static u8 ring_out;
static char line[LINE];
static u8 length;

void INTERRUPT _U1RXInterrupt(void) {
    IFS0 &= ~U1RXIF;
    while (U1STA & URXDA) {
        const u8 next = (ring_in + 1) & (RING - 1);
        const u8 bad = (U1STA & FERR) != 0;
        const char character = (char)U1RXREG;
        if (bad || next == ring_out) continue;
        ring[ring_in] = character;
        ring_in = next;
    }
    if (U1STA & OERR) U1STA &= ~OERR;
}

void console_start(void) {
    U1BRG = FCY / (16 * BAUD) - 1;
    U1MODE = UARTEN;
    U1STA = UTXEN;
    IFS0 &= ~U1RXIF;
    IPC2 = (IPC2 & ~IP_MASK(U1RXIP)) | U1RXIP(LEVEL_UART);
    IEC0 |= U1RXIF;
}

const char* console_line(void) {
    while (ring_out != ring_in) {
        const char character = ring[ring_out];
        ring_out = (ring_out + 1) & (RING - 1);
        if (character == '\r' || character == '\n') {
            if (length == 0) continue; /* the second half of an end, or an empty line */
            line[length] = 0;
            length = 0;
            return line;
        }
        if (length < LINE - 1) line[length++] = character; /* what is too long loses its tail */
    }
    return 0;
}

void console_put(char character) {
    while (U1STA & UTXBF) continue;
    U1TXREG = character;
}

void console_number(s16 value) {
    char digits[5];
    u8 count = 0;
    u16 rest = value < 0 ? -(u16)value : (u16)value;
    if (value < 0) console_put('-');
    do {
        digits[count++] = (char)('0' + rest % 10);
        rest /= 10;
    } while (rest != 0);
    while (count != 0) console_put(digits[--count]);
}
