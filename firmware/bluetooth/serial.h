/* UART1 to the Bluetooth module, UART2 for reports to whoever listens there; 115200 8N1. */
#ifndef BLUETOOTH_SERIAL_H
#define BLUETOOTH_SERIAL_H

#include "../epuck/types.h"

#define SERIAL_NOTHING 0xFFFFU

void serial_start(void);
/* The next byte from the module, or SERIAL_NOTHING. Bytes with framing errors, as of a break, are dropped. */
u16 serial_receive(void);
/* Forgets what has come. */
void serial_forget(void);
void serial_send(u8 byte);
/* Holds the line to the module low for 2 ms: transparent mode ends. */
void serial_break(void);

/* To UART2. */
void report(const char* text);
void report_number(u32 number);
void report_byte(u8 byte);

#endif
