#include "potentiometer.h"

#include "board.h"
#include "registers.h"

#define DEFAULT_RANGE 100

static volatile u8 wanted;
static volatile u8 changed;

/* One byte at 312 kHz, 26 us. The chip select is moved by single instructions on the latch: they disturb no
 * emitter beside it. */
static void send(u8 value) {
    LATB &= ~CHIP_SELECT;
    SPI1BUF = value;
    while (!(SPI1STAT & SPIRBF))
        ;
    (void)SPI1BUF;
    LATB |= CHIP_SELECT;
}

void potentiometer_start(void) {
    SPI1STAT = 0;
    SPI1CON1 = MSTEN | CKE | SPRE_8 | PPRE_16;
    SPI1STAT = SPIEN;
    send(DEFAULT_RANGE);
}

void potentiometer_want(u8 value) {
    wanted = value;
    changed = 1;
}

void potentiometer_step(void) {
    if (!changed) return;
    changed = 0;
    send(wanted);
}
