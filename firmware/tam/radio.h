/* The XBee module on USART1: API frames with escapes (AP = 2), AT commands, data to the coordinator.
   TAM fact sheet, section 6. */
#ifndef RADIO_H
#define RADIO_H

#include "types.h"

#define RADIO_MOST 40 /* bytes of frame data that are kept; longer frames are dropped */

enum { RADIO_AT_RESPONSE = 0x88, RADIO_MODEM_STATUS = 0x8A, RADIO_TX_STATUS = 0x8B, RADIO_RX = 0x90 };

struct frame {
    u8 length;
    u8 data[RADIO_MOST]; /* [0] is the type */
};

/* A reset pulse of 120 ms, and the pins. */
void radio_reset(void);
/* 0: no whole frame has come in. */
u8 radio_receive(struct frame *frame);
void radio_command(const char *command, const u8 *value, u8 length);
/* To a 64-bit address; returns the frame's id, 1..255. */
u8 radio_send(const u8 *address, const u8 *payload, u8 length);
/* Frames that were damaged. */
u16 radio_errors(void);

#endif
