#include "serial.h"

#include "../epuck/board.h"
#include "../epuck/clock.h"
#include "../epuck/registers.h"

SFR(U1MODE, 0x20C);
SFR(U1STA, 0x20E);
SFR(U1TXREG, 0x210);
SFR(U1RXREG, 0x212);
SFR(U1BRG, 0x214);
#define U1RXIF (1 << 9)             /* IFS0, IEC0 */
#define U1RXIP(level) ((level) << 4) /* IPC2 */
#define UTXBRK 0x0800               /* UxSTA */
#define TRMT 0x0100                 /* UxSTA */

#define BAUD 115200UL
#define RING 512 /* a power of two: more than the longest packet */

static volatile u8 ring[RING];
static volatile u16 ring_in;
static volatile u16 ring_out;

void INTERRUPT _U1RXInterrupt(void) {
    IFS0 &= ~U1RXIF;
    while (U1STA & URXDA) {
        const u8 bad = (U1STA & FERR) != 0; /* belongs to the byte on top */
        const u8 byte = (u8)U1RXREG;
        const u16 next = (ring_in + 1) & (RING - 1);
        if (bad || next == ring_out) continue;
        ring[ring_in] = byte;
        ring_in = next;
    }
    if (U1STA & OERR) U1STA &= ~OERR;
}

void serial_start(void) {
    U1MODE = 0;
    U1STA = 0;
    U1BRG = FCY / (16 * BAUD) - 1; /* 7: exact */
    U1MODE = UARTEN;
    U1STA = UTXEN;
    IFS0 &= ~U1RXIF;
    IPC2 = (IPC2 & ~IP_MASK(U1RXIP)) | U1RXIP(LEVEL_UART);
    IEC0 |= U1RXIF;
    U2MODE = 0;
    U2BRG = FCY / (16 * BAUD) - 1;
    U2MODE = UARTEN;
    U2STA = UTXEN;
}

u16 serial_receive(void) {
    u8 byte;
    if (ring_out == ring_in) return SERIAL_NOTHING;
    byte = ring[ring_out];
    ring_out = (ring_out + 1) & (RING - 1);
    return byte;
}

void serial_forget(void) {
    ring_out = ring_in;
}

void serial_send(u8 byte) {
    while (U1STA & UTXBF) {
    }
    U1TXREG = byte;
}

/* By UTXBRK, so that the receiver stays on: the module answers while the line is low. */
void serial_break(void) {
    u16 begin;
    while (!(U1STA & TRMT)) continue; /* the last byte is on its way until then */
    U1STA |= UTXBRK;
    begin = clock_ticks();
    while ((u16)(clock_ticks() - begin) < 3) IDLE();
    U1STA &= ~UTXBRK;
}

void report_byte(u8 byte) {
    while (U2STA & UTXBF) {
    }
    U2TXREG = byte;
}

void report(const char* text) {
    while (*text != 0) report_byte((u8)*text++);
}

void report_number(u32 number) {
    static const u32 power[] = {1000000000, 100000000, 10000000, 1000000, 100000, 10000, 1000, 100, 10, 1};
    u8 i;
    u8 begun = 0;
    for (i = 0; i < sizeof power / sizeof *power; ++i) {
        u8 digit = '0';
        while (number >= power[i]) {
            number -= power[i];
            ++digit;
        }
        begun |= digit != '0' || power[i] == 1;
        if (begun) report_byte(digit);
    }
}
