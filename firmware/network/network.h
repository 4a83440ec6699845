/* Packets from robot to robot by number, by the carrier that the selector chose: WiFi by the Linux board on
 * UART2, or Bluetooth by the module on UART1. */
#ifndef NETWORK_NETWORK_H
#define NETWORK_NETWORK_H

#include "packet.h"

#define RECEIVE_TIMEOUT (3 * 1024) /* ticks of 1/1024 s after which a receive call gives up at most */

/* What the robot does while it waits; called every millisecond and more often. */
typedef void (*Background)(void);

/* `wifi`: by UART2, else by Bluetooth. */
void network_start(u8 wifi, Background background);
/* To robot `to`, 0 to 9998, or EVERYBODY. Returns when the packet is on its way: by UART2 at once, by
 * Bluetooth after inquiry, link and release; the robot must stand meanwhile. 0: by Bluetooth nobody was
 * reached. */
u8 network_send(u16 to, const u8* data, u8 length);
/* The next packet. 0: none came within `ticks`, which RECEIVE_TIMEOUT limits. */
u8 network_receive(struct NetworkPacket* packet, u16 ticks);

#endif
