/* The registers and bits of the dsPIC30F6014A that main.c uses, under the data sheet's names (DS70143). With XC16's own
 * header, #include <xc.h> in its place. Addresses are absolute: no device library is needed. */
#ifndef REGISTERS_H
#define REGISTERS_H

#define SFR(name, address) extern volatile unsigned int name __attribute__((sfr(address), near))

/* Interrupts */
SFR(IFS0, 0x084);
SFR(IEC0, 0x08C);
SFR(IPC0, 0x094);
#define T1IF (1 << 3) /* IFS0, and T1IE in IEC0 */
#define T1IP(level) ((level) << 12)

/* Timer 1 */
SFR(PR1, 0x102);
SFR(T1CON, 0x104);
#define TON 0x8000
#define TCKPS_64 0x0020

/* UART2: the Linux board, or the connector */
SFR(U2MODE, 0x216);
SFR(U2STA, 0x218);
SFR(U2TXREG, 0x21A);
SFR(U2RXREG, 0x21C);
SFR(U2BRG, 0x21E);
#define UARTEN 0x8000
#define UTXEN 0x0400
#define UTXBF 0x0200
#define OERR 0x0002
#define URXDA 0x0001

/* Port A: the LEDs of the ring */
SFR(TRISA, 0x2C0);
SFR(LATA, 0x2C4);
#define LED0 (1 << 6)
#define LED1 (1 << 7)

#define INTERRUPT __attribute__((interrupt, no_auto_psv))

#endif
