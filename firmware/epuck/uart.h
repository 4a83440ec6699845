/* UART2 to the Linux board, 115200 8N1, interrupt-driven both ways. */
#ifndef EPUCK_UART_H
#define EPUCK_UART_H

#include "types.h"

#define UART_NOTHING 0xFFFFU
#define UART_BAD 0x8000U /* received with a framing error, or stands for bytes lost in an overrun */

void uart_start(void);
/* The next received byte (with UART_BAD if it cannot be trusted), or UART_NOTHING. */
u16 uart_receive(void);
/* A receiver whose FIFO filled up without an interrupt being served is deaf: it hears again. */
void uart_listen(void);
/* Clock tick at which the newest byte came. */
u16 uart_last_byte(void);
/* Sends `count` bytes, which must stay unchanged until uart_sending() is 0 again. */
void uart_send(const u8* bytes, u16 count);
u8 uart_sending(void);

#endif
