/* The two serial lines, 8N1, with a buffer each way. */
#ifndef UART_H
#define UART_H

#include "types.h"

void uart_start(void);
/* Waits while the buffer is full. */
void uart_send(u8 unit, u8 byte);
/* 0: nothing came in. */
u8 uart_receive(u8 unit, u8 *byte);
/* Bytes lost or damaged since the last call: the reader has to find its place anew. */
u8 uart_broken(u8 unit);

void print(const char *text);
void print_number(u16 number);

#endif
