/* Packets between robots as text: "NUMBER DATA" and CR. Towards the network NUMBER is who gets it, from there
 * who sent it; docs/network.md. */
#ifndef NETWORK_PACKET_H
#define NETWORK_PACKET_H

#include "../epuck/types.h"

#define EVERYBODY 9999
#define PACKET_DATA 48                    /* longest data */
#define PACKET_LINE (5 + PACKET_DATA + 1) /* longest line: four digits, a space, data, CR */

struct NetworkPacket {
    u16 number; /* who sent it */
    u8 length;
    u8 data[PACKET_DATA];
};

/* A line that comes in byte by byte. */
struct Line {
    u8 bytes[PACKET_LINE];
    u8 length;
    u8 bad; /* until its end: too long, or a byte of it cannot be trusted */
};

/* Writes four digits, a space, the data (at most PACKET_DATA) and CR to `line`; its length. */
u8 packet_write(u8* line, u16 number, const u8* data, u8 length);
/* Takes a byte. 1: it ended a line, which is in `packet`. Lines that are no packet are dropped. */
u8 packet_take(struct Line* line, u8 byte, struct NetworkPacket* packet);
/* What has come of the line cannot be trusted. */
void packet_spoil(struct Line* line);

#endif
