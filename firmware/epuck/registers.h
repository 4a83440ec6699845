/* The dsPIC30F6014A registers and bits this firmware uses, under the data sheet's names.
 * Addresses are absolute, so that no device library or linker table is needed. */
#ifndef EPUCK_REGISTERS_H
#define EPUCK_REGISTERS_H

#include "types.h"

#define SFR(name, address) extern volatile u16 name __attribute__((sfr(address), near))

/* Interrupt controller */
SFR(INTCON1, 0x080);
SFR(IFS0, 0x084);
SFR(IFS1, 0x086);
SFR(IEC0, 0x08C);
SFR(IEC1, 0x08E);
SFR(IPC0, 0x094);
SFR(IPC1, 0x096);
SFR(IPC2, 0x098);
SFR(IPC5, 0x09E);
SFR(IPC6, 0x0A0);
#define T1IF (1 << 3)  /* IFS0, and T1IE in IEC0 */
#define ADIF (1 << 11) /* IFS0, IEC0 */
#define T2IF (1 << 6)  /* IFS0, IEC0 */
#define T4IF (1 << 5)  /* IFS1, IEC1 */
#define T5IF (1 << 6)  /* IFS1, IEC1 */
#define U2RXIF (1 << 8)
#define U2TXIF (1 << 9)
#define T1IP(level) ((level) << 12)  /* IPC0 */
#define T2IP(level) ((level) << 8)   /* IPC1 */
#define ADIP(level) ((level) << 12)  /* IPC2 */
#define T4IP(level) ((level) << 4)   /* IPC5 */
#define T5IP(level) ((level) << 8)   /* IPC5 */
#define U2RXIP(level) (level)        /* IPC6 */
#define U2TXIP(level) ((level) << 4) /* IPC6 */
#define IP_MASK(field) (field(7))

/* Timers */
SFR(TMR1, 0x100);
SFR(PR1, 0x102);
SFR(T1CON, 0x104);
SFR(TMR2, 0x106);
SFR(PR2, 0x10C);
SFR(T2CON, 0x110);
SFR(TMR4, 0x114);
SFR(TMR5, 0x118);
SFR(PR4, 0x11A);
SFR(PR5, 0x11C);
SFR(T4CON, 0x11E);
SFR(T5CON, 0x120);
#define TON 0x8000
#define TCKPS_8 0x0010
#define TCKPS_64 0x0020
#define TCKPS_256 0x0030

/* UART2 */
SFR(U2MODE, 0x216);
SFR(U2STA, 0x218);
SFR(U2TXREG, 0x21A);
SFR(U2RXREG, 0x21C);
SFR(U2BRG, 0x21E);
#define UARTEN 0x8000
#define UTXISEL 0x8000
#define UTXEN 0x0400
#define UTXBF 0x0200
#define FERR 0x0004
#define OERR 0x0002
#define URXDA 0x0001

/* 12-bit A/D converter */
SFR(ADCBUF0, 0x280); /* to ADCBUFF */
SFR(ADCON1, 0x2A0);
SFR(ADCON2, 0x2A2);
SFR(ADCON3, 0x2A4);
SFR(ADCHS, 0x2A6);
SFR(ADPCFG, 0x2A8);
SFR(ADCSSL, 0x2AA);
#define ADON 0x8000
#define SSRC_AUTO 0x00E0
#define ASAM 0x0004
#define CSCNA 0x0400
#define SMPI(conversions) (((conversions)-1) << 2)
#define SAMC(tad) ((tad) << 8)
#define ADCS(half_tcy) ((half_tcy)-1)

/* Ports */
SFR(TRISA, 0x2C0);
SFR(LATA, 0x2C4);
SFR(TRISC, 0x2CC);
SFR(LATC, 0x2D0);
SFR(TRISD, 0x2D2);
SFR(LATD, 0x2D6);
SFR(TRISF, 0x2DE);
SFR(PORTF, 0x2E0);
SFR(LATF, 0x2E2);
SFR(TRISG, 0x2E4);
SFR(LATG, 0x2E8);

/* Reset causes */
SFR(RCON, 0x740);
#define POR 0x0001
#define BOR 0x0002
#define RESET_CAUSES 0xC0D3 /* TRAPR IOPUWR EXTR SWR WDTO BOR POR */

#define INTERRUPT __attribute__((interrupt, no_auto_psv))
/* Stops the core until the next interrupt; clocks and peripherals run on. */
#define IDLE() __asm__ volatile("pwrsav #1")

#endif
