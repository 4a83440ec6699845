#include "module.h"

#include "../epuck/clock.h"
#include "../epuck/registers.h"
#include "serial.h"

#define STX 0x02
#define ETX 0x03
#define REQUEST 0x52

void module_request(u8 opcode, const u8* data, u16 length) {
    const u8 low = (u8)length;
    const u8 high = (u8)(length >> 8);
    u16 i;
    serial_send(STX);
    serial_send(REQUEST);
    serial_send(opcode);
    serial_send(low);
    serial_send(high);
    serial_send((u8)(REQUEST + opcode + low + high));
    for (i = 0; i < length; ++i) serial_send(data[i]);
    serial_send(ETX);
}

/* Place in the packet that is coming in: 0 outside, 1..5 header, 6 on data and end. */
static u16 place;
static u8 sum;

u8 module_poll(struct Packet* packet, u8* plain) {
    for (;;) {
        const u16 entry = serial_receive();
        const u8 byte = (u8)entry;
        if (entry == SERIAL_NOTHING) return 0;
        if (place == 0) {
            if (byte != STX) {
                *plain = byte;
                return 2;
            }
            place = 1;
            sum = 0;
            continue;
        }
        if (place < 5) sum += byte;
        if (place == 1) packet->type = byte;
        if (place == 2) packet->opcode = byte;
        if (place == 3) packet->length = byte;
        if (place == 4) packet->length |= (u16)byte << 8;
        if (place == 5 && byte != sum) {
            place = 0;
            continue;
        }
        if (place >= 6) {
            const u16 at = place - 6;
            if (at == packet->length) {
                place = 0;
                if (byte == ETX) return 1;
                continue;
            }
            if (at < MOST_DATA) packet->data[at] = byte;
        }
        ++place;
    }
}

u8 module_await(u8 type, u8 opcode, struct Packet* packet, u16 ticks) {
    const u16 begin = clock_ticks();
    u8 plain;
    while ((u16)(clock_ticks() - begin) < ticks) {
        const u8 got = module_poll(packet, &plain);
        if (got == 1 && packet->type == type && packet->opcode == opcode) return 1;
        if (got == 0) IDLE();
    }
    return 0;
}
