#include "radio.h"

#include "../bluetooth/exchange.h"
#include "../bluetooth/module.h"
#include "../bluetooth/serial.h"
#include "../epuck/clock.h"
#include "../epuck/registers.h"

#define MOST_FOUND 8
#define ADDRESS 6
#define PIN 4
#define NAME_PREFIX 7 /* "e-puck_" */

static struct Packet packet;
static struct Line incoming;
static u8 own_pin[PIN];
static struct NetworkPacket kept; /* that came while the robot was sending */
static u8 has_kept;

/* A plain byte: another robot's, by a link that it made. */
static void keep(u8 byte) {
    if (packet_take(&incoming, byte, &kept)) has_kept = 1;
}

/* As module_await(), but what comes by a link meanwhile is kept. */
static u8 await(u8 type, u8 opcode, u16 ticks) {
    const u16 begin = clock_ticks();
    u8 byte;
    while ((u16)(clock_ticks() - begin) < ticks) {
        const u8 got = module_poll(&packet, &byte);
        if (got == 1 && packet.type == type && packet.opcode == opcode) return 1;
        if (got == 2) keep(byte);
        if (got == 0) IDLE();
    }
    return 0;
}

static u16 number_of(const u8* digits) {
    u16 number = 0;
    u8 i;
    for (i = 0; i < PIN; ++i)
        number = number * 10 + (digits[i] - '0');
    return number;
}

u16 radio_number(void) {
    return number_of(own_pin);
}

static void write_pin(const u8* pin) {
    u8 data[1 + PIN];
    u8 i;
    data[0] = PIN;
    for (i = 0; i < PIN; ++i)
        data[1 + i] = pin[i];
    module_request(WRITE_PIN, data, sizeof data);
    await(CONFIRM, WRITE_PIN, SECONDS(1));
}

void radio_start(void) {
    u8 i;
    serial_start();
    module_request(READ_PIN, own_pin, 0);
    await(CONFIRM, READ_PIN, SECONDS(1));
    for (i = 0; i < PIN; ++i)
        own_pin[i] = packet.data[2 + i];
}

/* The devices that answer an inquiry as e-pucks do: no class, an address of 08:... */
static u16 find(u8 addresses[][ADDRESS]) {
    static const u8 inquiry[] = {5, 10, 0};
    const u16 begin = clock_ticks();
    u16 found = 0; /* 16 bits: eight are multiplied by a register that the linker script does not have */
    u8 plain;
    u8 i;
    module_request(INQUIRY, inquiry, sizeof inquiry);
    while ((u16)(clock_ticks() - begin) < SECONDS(20)) {
        const u8 got = module_poll(&packet, &plain);
        if (got == 1 && packet.type == INDICATION && packet.opcode == DEVICE_FOUND && found < MOST_FOUND &&
            packet.data[5] == 0x08 && (packet.data[6] | packet.data[7] | packet.data[8]) == 0) {
            for (i = 0; i < ADDRESS; ++i)
                addresses[found][i] = packet.data[i];
            ++found;
        }
        if (got == 1 && packet.type == CONFIRM && packet.opcode == INQUIRY) break;
        if (got == 2) keep(plain);
        if (got == 0) IDLE();
    }
    return found;
}

/* The four digits behind "e-puck_" of the device's name. 0: it has no such name. */
static u8 ask_name(const u8* address, u8* digits) {
    u8 i;
    module_request(REMOTE_NAME, address, ADDRESS);
    if (!await(CONFIRM, REMOTE_NAME, SECONDS(20)) || packet.data[0] != 0 ||
        packet.data[7] < NAME_PREFIX + PIN)
        return 0;
    for (i = 0; i < PIN; ++i) {
        digits[i] = packet.data[8 + NAME_PREFIX + i];
        if (digits[i] < '0' || digits[i] > '9') return 0;
    }
    return 1;
}

static u8 link_with(const u8* address, const u8* pin) {
    const u8 port = 1;
    u8 wanted[ADDRESS + 2];
    u8 linked;
    u8 i;
    write_pin(pin);
    wanted[0] = wanted[ADDRESS + 1] = port;
    for (i = 0; i < ADDRESS; ++i)
        wanted[1 + i] = address[i];
    module_request(ESTABLISH_LINK, wanted, sizeof wanted);
    linked = await(INDICATION, LINK_ESTABLISHED, SECONDS(60)) && packet.data[0] == 0;
    write_pin(own_pin);
    if (!linked) return 0;
    module_request(TRANSPARENT_MODE, &port, 1);
    await(CONFIRM, TRANSPARENT_MODE, SECONDS(1));
    return 1;
}

static void release(void) {
    const u8 port = 1;
    serial_break();
    await(INDICATION, TRANSPARENT_MODE, SECONDS(1));
    module_request(RELEASE_LINK, &port, 1);
    await(INDICATION, LINK_RELEASED, SECONDS(10));
}

static void report_digits(const char* what, const u8* digits) {
    u8 i;
    report(what);
    for (i = 0; i < PIN; ++i)
        report_byte(digits[i]);
    report("\r\n");
}

static void send_line(const u8* line, u8 size) {
    while (size-- != 0)
        serial_send(*line++);
}

u8 radio_send(u16 to, const u8* data, u8 length) {
    static u8 addresses[MOST_FOUND][ADDRESS];
    static u8 line[PACKET_LINE];
    const u8 size = packet_write(line, radio_number(), data, length);
    u8 reached = 0;
    u16 found;
    u16 i;
    found = find(addresses);
    if (found == 0) report("nobody found\r\n");
    for (i = 0; i < found; ++i) {
        u8 digits[PIN];
        if (!ask_name(addresses[i], digits) || (to != EVERYBODY && number_of(digits) != to)) continue;
        if (!link_with(addresses[i], digits)) {
            report_digits("not linked ", digits);
            continue;
        }
        send_line(line, size);
        pause(SECONDS(1)); /* on the air before the link is released */
        release();
        report_digits("sent ", digits);
        reached = 1;
        if (to != EVERYBODY) break;
    }
    return reached;
}

u8 radio_receive(struct NetworkPacket* received) {
    u8 byte;
    u8 got;
    if (has_kept) {
        has_kept = 0;
        *received = kept;
        return 1;
    }
    while ((got = module_poll(&packet, &byte)) != 0)
        if (got == 2 && packet_take(&incoming, byte, received)) return 1;
    return 0;
}
