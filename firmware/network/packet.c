#include "packet.h"

#define CR 0x0D
#define LF 0x0A

u8 packet_write(u8* line, u16 number, const u8* data, u8 length) {
    static const u16 power[] = {1000, 100, 10, 1};
    u8 at = 0;
    u8 i;
    for (i = 0; i < sizeof power / sizeof *power; ++i) {
        u8 digit = '0';
        while (number >= power[i]) {
            number -= power[i];
            ++digit;
        }
        line[at++] = digit;
    }
    line[at++] = ' ';
    for (i = 0; i < length && i < PACKET_DATA; ++i)
        line[at++] = data[i];
    line[at++] = CR;
    return at;
}

/* One to four digits, and a space or nothing. */
static u8 read_packet(const struct Line* line, struct NetworkPacket* packet) {
    u8 at = 0;
    packet->number = 0;
    while (at < line->length && line->bytes[at] >= '0' && line->bytes[at] <= '9') {
        if (at == 4) return 0;
        packet->number = packet->number * 10 + (line->bytes[at] - '0');
        ++at;
    }
    if (at == 0 || (at < line->length && line->bytes[at] != ' ')) return 0;
    if (at < line->length) ++at;
    packet->length = 0;
    while (at < line->length && packet->length < PACKET_DATA)
        packet->data[packet->length++] = line->bytes[at++];
    return at == line->length;
}

u8 packet_take(struct Line* line, u8 byte, struct NetworkPacket* packet) {
    u8 whole;
    if (byte == LF && line->length == 0) return 0;
    if (byte != CR) {
        if (line->length == PACKET_LINE)
            line->bad = 1;
        else
            line->bytes[line->length++] = byte;
        return 0;
    }
    whole = !line->bad && read_packet(line, packet);
    line->length = 0;
    line->bad = 0;
    return whole;
}

void packet_spoil(struct Line* line) {
    line->bad = 1;
}
