/* What this firmware uses beside ../epuck/registers.h, under the data sheet's names. */
#ifndef SOUND_REGISTERS_H
#define SOUND_REGISTERS_H

#include "../epuck/registers.h"

/* Interrupt controller */
SFR(IFS2, 0x088);
SFR(IEC2, 0x090);
SFR(IPC10, 0x0A8);
#define DCIIF (1 << 9)               /* IFS2, and DCIIE in IEC2 */
#define DCIIP(level) ((level) << 4)  /* IPC10 */
#define U1RXIF (1 << 9)              /* IFS0, IEC0 */
#define U1TXIF (1 << 10)             /* IFS0, IEC0 */
#define U1RXIP(level) ((level) << 4) /* IPC2 */
#define U1TXIP(level) ((level) << 8) /* IPC2 */

/* UART1 */
SFR(U1MODE, 0x20C);
SFR(U1STA, 0x20E);
SFR(U1TXREG, 0x210);
SFR(U1RXREG, 0x212);
SFR(U1BRG, 0x214);

/* Data converter interface */
SFR(DCICON1, 0x240);
SFR(DCICON2, 0x242);
SFR(DCICON3, 0x244);
SFR(DCISTAT, 0x246);
SFR(TSCON, 0x248);
SFR(RSCON, 0x24C);
SFR(RXBUF0, 0x250);
SFR(TXBUF0, 0x258);
SFR(TXBUF1, 0x25A);
#define DCIEN 0x8000
#define BLEN_2 0x0400 /* two words between interrupts */
#define COFSG(words) (((words)-1) << 5)
#define WS_16 0x000F /* words of sixteen bits */
#define TMPTY 0x0001

/* Ports */
SFR(PORTG, 0x2E6);

#endif
