/* The Bluetooth module LMX9820A: requests and what it answers. */
#ifndef BLUETOOTH_MODULE_H
#define BLUETOOTH_MODULE_H

#include "../epuck/types.h"

#define CONFIRM 0x43
#define INDICATION 0x69

/* Opcodes */
#define INQUIRY 0x00
#define DEVICE_FOUND 0x01
#define REMOTE_NAME 0x02
#define READ_PIN 0x16
#define WRITE_PIN 0x17
#define ESTABLISH_LINK 0x0A
#define LINK_ESTABLISHED 0x0B
#define INCOMING_LINK 0x0C
#define RELEASE_LINK 0x0D
#define LINK_RELEASED 0x0E
#define TRANSPARENT_MODE 0x11

#define MOST_DATA 64 /* of a packet that is kept; the rest of a longer one is passed over */

struct Packet {
    u8 type, opcode;
    u16 length;
    u8 data[MOST_DATA];
};

void module_request(u8 opcode, const u8* data, u16 length);
/* Takes what has come. 1: `packet` is the next whole packet, check and end right. A byte outside of packets
 * goes to `plain`, and the answer is 2. 0: nothing more has come. */
u8 module_poll(struct Packet* packet, u8* plain);
/* The next packet of this kind; others are dropped. 0: not within so many ticks of 1/1024 s. */
u8 module_await(u8 type, u8 opcode, struct Packet* packet, u16 ticks);

#endif
