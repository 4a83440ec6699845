/* Both UARTs at 57600 8N1, to and from rings, by interrupts. */
#ifndef RAB_UART_H
#define RAB_UART_H

#include "types.h"

enum uart { ROBOT, PC }; /* UART1, UART2 */

#define UART_NOTHING 0x8000U

void uart_start(void);
/* Bytes that find no room are dropped: nothing waits for a line nobody reads. */
void uart_put(enum uart uart, u8 byte);
void uart_text(enum uart uart, const char* text);
/* The oldest byte received, or UART_NOTHING. */
u16 uart_get(enum uart uart);

#endif
