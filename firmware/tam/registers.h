/* Registers of the ATmega1284P that this firmware uses, by data address (data sheet 8272, "Register Summary"). */
#ifndef REGISTERS_H
#define REGISTERS_H

#include "types.h"

#define REGISTER8(address) (*(volatile u8 *)(address))
#define REGISTER16(address) (*(volatile u16 *)(address))

#define PINB REGISTER8(0x23)
#define DDRB REGISTER8(0x24)
#define PORTB REGISTER8(0x25)
#define DDRC REGISTER8(0x27)
#define PORTC REGISTER8(0x28)
#define PIND REGISTER8(0x29)
#define DDRD REGISTER8(0x2A)
#define PORTD REGISTER8(0x2B)

#define TIFR1 REGISTER8(0x36)
#define TIFR2 REGISTER8(0x37)
#define TIMSK0 REGISTER8(0x6E)
#define TIMSK1 REGISTER8(0x6F)
#define TIMSK2 REGISTER8(0x70)
#define OCIEA 0x02 /* in all of them */
#define ICIE1 0x20
#define ICF1 0x20

#define TCCR0A REGISTER8(0x44)
#define TCCR0B REGISTER8(0x45)
#define OCR0A REGISTER8(0x47)
#define TCCR1B REGISTER8(0x81)
#define ICR1 REGISTER16(0x86)
#define TCCR2A REGISTER8(0xB0)
#define TCCR2B REGISTER8(0xB1)
#define TCNT2 REGISTER8(0xB2)
#define OCR2A REGISTER8(0xB3)
#define WGM_CTC 0x02   /* TCCR0A, TCCR2A: clear the counter at OCRnA */
#define CS0_64 0x03    /* TCCR0B: clock / 64 */
#define CS1_8 0x02     /* TCCR1B: clock / 8 */
#define CS2_64 0x04    /* TCCR2B: clock / 64 */
#define ICES1 0x40     /* TCCR1B: capture at a rising edge */
#define ICNC1 0x80     /* TCCR1B: an edge counts after four equal samples */

#define SMCR REGISTER8(0x53)
#define SLEEP_ENABLE 0x01 /* mode 000: Idle */
#define MCUSR REGISTER8(0x54)
#define SPL REGISTER8(0x5D)
#define SPH REGISTER8(0x5E)
#define SREG REGISTER8(0x5F)
#define WDTCSR REGISTER8(0x60)
#define WDCE 0x10
#define WDE_1S 0x0E /* WDE and a period of 1 s */

#define ADC REGISTER16(0x78)
#define ADCSRA REGISTER8(0x7A)
#define ADMUX REGISTER8(0x7C)
#define DIDR0 REGISTER8(0x7E)
#define ADEN 0x80
#define ADSC 0x40
#define ADPS_128 0x07
#define REFS_AVCC 0x40

#define TWBR REGISTER8(0xB8)
#define TWSR REGISTER8(0xB9)
#define TWDR REGISTER8(0xBB)
#define TWCR REGISTER8(0xBC)
#define TWINT 0x80
#define TWSTA 0x20
#define TWSTO 0x10
#define TWEN 0x04

/* The two USARTs lie 8 apart. */
#define UCSRA(unit) REGISTER8(0xC0 + 8 * (unit))
#define UCSRB(unit) REGISTER8(0xC1 + 8 * (unit))
#define UCSRC(unit) REGISTER8(0xC2 + 8 * (unit))
#define UBRR(unit) REGISTER16(0xC4 + 8 * (unit))
#define UDR(unit) REGISTER8(0xC6 + 8 * (unit))
#define FE 0x10
#define DOR 0x08
#define U2X 0x02
#define RXCIE 0x80
#define UDRIE 0x20
#define RXEN 0x10
#define TXEN 0x08
#define UCSZ_8 0x06

#define SEI() __asm__ __volatile__("sei" ::: "memory")
#define CLI() __asm__ __volatile__("cli" ::: "memory")
#define SLEEP() __asm__ __volatile__("sleep" ::: "memory")
#define WDR() __asm__ __volatile__("wdr")

/* Interrupt service routines; crt0.S has the vectors, and the compiler knows routines by these names. */
#define TIMER2_COMPA __vector_9
#define TIMER1_CAPT __vector_12
#define TIMER0_COMPA __vector_16
#define USART0_RX __vector_20
#define USART0_UDRE __vector_21
#define USART1_RX __vector_28
#define USART1_UDRE __vector_29
#define INTERRUPT(name) void __attribute__((signal, used, externally_visible)) name(void)

#endif
