/* Packets by Bluetooth: a link for each, to the e-puck whose name ends with the number. */
#ifndef NETWORK_RADIO_H
#define NETWORK_RADIO_H

#include "packet.h"

/* The module must have been powered for 2 s. */
void radio_start(void);
/* Own number: the four digits of the module's PIN. */
u16 radio_number(void);
/* Looks for e-pucks (5 x 1.28 s), asks their names, links with each that is meant and sends the packet, with
 * the own number in it. Reports to UART2: "sent 1234", "not linked 1234", "nobody found". 0: nobody got it.
 */
u8 radio_send(u16 to, const u8* data, u8 length);
/* A packet that has come by a link that another one made. 0: none. */
u8 radio_receive(struct NetworkPacket* packet);

#endif
