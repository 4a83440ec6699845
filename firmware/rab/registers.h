/* The dsPIC33FJ256GP710 registers and bits this firmware uses, under the data sheet's names.
 * Addresses are absolute, so that no device library or linker table is needed. */
#ifndef RAB_REGISTERS_H
#define RAB_REGISTERS_H

#include "types.h"

#define SFR(name, address) extern volatile u16 name __attribute__((sfr(address), near))

/* Interrupt controller */
SFR(IFS0, 0x084);
SFR(IFS1, 0x086);
SFR(IEC0, 0x094);
SFR(IEC1, 0x096);
SFR(IPC0, 0x0A4);
SFR(IPC2, 0x0A8);
SFR(IPC3, 0x0AA);
SFR(IPC4, 0x0AC);
SFR(IPC5, 0x0AE);
SFR(IPC7, 0x0B2);
#define T1IF (1 << 3) /* IFS0, and T1IE in IEC0; so are the others */
#define T3IF (1 << 8)
#define U1RXIF (1 << 11)
#define U1TXIF (1 << 12)
#define AD1IF (1 << 13)
#define SI2C1IF (1 << 0) /* IFS1, IEC1 */
#define INT1IF (1 << 4)
#define U2RXIF (1 << 14)
#define U2TXIF (1U << 15)
#define T1IP(level) ((level) << 12)   /* IPC0 */
#define T3IP(level) (level)           /* IPC2 */
#define U1RXIP(level) ((level) << 12) /* IPC2 */
#define U1TXIP(level) (level)         /* IPC3 */
#define AD1IP(level) ((level) << 4)   /* IPC3 */
#define SI2C1IP(level) (level)        /* IPC4 */
#define INT1IP(level) (level)         /* IPC5 */
#define U2RXIP(level) ((level) << 8)  /* IPC7 */
#define U2TXIP(level) ((level) << 12) /* IPC7 */
#define IP_MASK(field) (field(7))

/* Timers */
SFR(TMR1, 0x100);
SFR(PR1, 0x102);
SFR(T1CON, 0x104);
SFR(TMR2, 0x106);
SFR(TMR3, 0x10A);
SFR(PR2, 0x10C);
SFR(PR3, 0x10E);
SFR(T2CON, 0x110);
SFR(T3CON, 0x112);
#define TON 0x8000

/* Output compare 1 */
SFR(OC1RS, 0x180);
SFR(OC1R, 0x182);
SFR(OC1CON, 0x184);
#define OCM_PWM 0x0006

/* I2C1 */
SFR(I2C1RCV, 0x200);
SFR(I2C1TRN, 0x202);
SFR(I2C1CON, 0x206);
SFR(I2C1STAT, 0x208);
SFR(I2C1ADD, 0x20A);
#define I2CEN 0x8000
#define SCLREL 0x1000
#define STREN 0x0040
#define I2COV 0x0040
#define D_A 0x0020
#define R_W 0x0004

/* UART1 and UART2 */
SFR(U1MODE, 0x220);
SFR(U1STA, 0x222);
SFR(U1TXREG, 0x224);
SFR(U1RXREG, 0x226);
SFR(U1BRG, 0x228);
SFR(U2MODE, 0x230);
SFR(U2STA, 0x232);
SFR(U2TXREG, 0x234);
SFR(U2RXREG, 0x236);
SFR(U2BRG, 0x238);
#define UARTEN 0x8000
#define BRGH 0x0008
#define UTXEN 0x0400
#define UTXBF 0x0200
#define FERR 0x0004
#define OERR 0x0002
#define URXDA 0x0001

/* SPI1 */
SFR(SPI1STAT, 0x240);
SFR(SPI1CON1, 0x242);
SFR(SPI1BUF, 0x248);
#define SPIEN 0x8000
#define SPIROV 0x0040
#define SPIRBF 0x0001
#define CKE 0x0100
#define MSTEN 0x0020
#define SPRE_8 0x0000
#define PPRE_16 0x0001

/* Ports */
SFR(TRISA, 0x2C0);
SFR(LATA, 0x2C4);
SFR(TRISB, 0x2C6);
SFR(LATB, 0x2CA);
SFR(PORTD, 0x2D4);
SFR(TRISF, 0x2DE);
SFR(LATF, 0x2E2);
SFR(TRISG, 0x2E4);
SFR(LATG, 0x2E8);

/* 12-bit A/D converter 1 */
SFR(ADC1BUF0, 0x300);
SFR(AD1CON1, 0x320);
SFR(AD1CON2, 0x322);
SFR(AD1CON3, 0x324);
SFR(AD1CHS0, 0x328);
SFR(AD1PCFGH, 0x32A);
SFR(AD1PCFGL, 0x32C);
#define ADON 0x8000
#define AD12B 0x0400
#define SSRC_AUTO 0x00E0
#define SAMP 0x0002
#define SAMC(tad) ((tad) << 8)
#define ADCS(tcy) ((tcy)-1)

/* Clock */
SFR(OSCCON, 0x742);
SFR(CLKDIV, 0x744);
SFR(PLLFBD, 0x746);
#define COSC 0x7000
#define COSC_PRIMARY_PLL 0x3000
#define OSWEN 0x0001
#define LOCK 0x0020

#define INTERRUPT __attribute__((interrupt, no_auto_psv))
/* Stops the core until the next interrupt; clocks and peripherals run on. */
#define IDLE() __asm__ volatile("pwrsav #1")
/* No interrupt below level 7 for so many cycles (up to 16383) and the next instruction. */
#define DISI(cycles) __asm__ volatile("disi #" #cycles : : : "memory")

#endif
