#include "exchange.h"

#include "../epuck/clock.h"
#include "../epuck/registers.h"
#include "module.h"
#include "serial.h"

static struct Packet packet;

void pause(u16 ticks) {
    const u16 begin = clock_ticks();
    while ((u16)(clock_ticks() - begin) < ticks) IDLE();
}

static u32 milliseconds_since(u16 begin) {
    return (u32)(u16)(clock_ticks() - begin) * 1000 / TICKS_PER_SECOND;
}

static void report_time(const char* what, u16 begin) {
    report(what);
    report(" ");
    report_number(milliseconds_since(begin));
    report(" ms\r\n");
}

static void send_line(const char* line) {
    while (*line != 0) serial_send((u8)*line++);
    serial_send('\n');
}

u8 listen(void) {
    static u8 in_line;
    u8 byte;
    const u8 got = module_poll(&packet, &byte);
    if (got == 1 && packet.type == INDICATION && packet.opcode == INCOMING_LINK) {
        report("linked\r\n");
        return LISTEN_LINKED;
    }
    if (got == 1 && packet.type == INDICATION && packet.opcode == LINK_RELEASED) {
        report("released\r\n");
        return LISTEN_RELEASED;
    }
    if (got != 2) return LISTEN_NOTHING;
    if (!in_line) report("heard ");
    in_line = byte != '\n';
    if (in_line) {
        report_byte(byte);
    } else {
        report("\r\n");
        send_line("yes");
    }
    return LISTEN_BYTE;
}

/* Whether the other says "yes" and ends the line within 2 s. */
static u8 answered(void) {
    const char* expected = "yes\n";
    const u16 begin = clock_ticks();
    while ((u16)(clock_ticks() - begin) < SECONDS(2)) {
        u8 byte;
        const u8 got = module_poll(&packet, &byte);
        if (got == 2 && byte == (u8)*expected && *++expected == 0) return 1;
        if (got == 0) IDLE();
    }
    return 0;
}

/* The first device that answers an inquiry of 5 x 1.28 s as e-pucks do: no class, an address of 08:... */
static u8 find(u8* address) {
    static const u8 inquiry[] = {5, 10, 0};
    const u16 begin = clock_ticks();
    u8 found = 0;
    u8 plain;
    module_request(INQUIRY, inquiry, sizeof inquiry);
    while ((u16)(clock_ticks() - begin) < SECONDS(20)) {
        const u8 got = module_poll(&packet, &plain);
        if (got == 1 && packet.type == INDICATION && packet.opcode == DEVICE_FOUND && !found &&
            packet.data[5] == 0x08 && (packet.data[6] | packet.data[7] | packet.data[8]) == 0) {
            u8 i;
            for (i = 0; i < 6; ++i) address[i] = packet.data[i];
            found = 1;
        }
        if (got == 1 && packet.type == CONFIRM && packet.opcode == INQUIRY) break;
        if (got == 0) IDLE();
    }
    return found;
}

static void write_pin(const u8* pin) {
    u8 data[5];
    u8 i;
    data[0] = 4;
    for (i = 0; i < 4; ++i) data[1 + i] = pin[i];
    module_request(WRITE_PIN, data, sizeof data);
    module_await(CONFIRM, WRITE_PIN, &packet, SECONDS(1));
}

/* Links with `address`, whose name ends with its PIN. */
static u8 link_with(const u8* address) {
    u8 own_pin[4];
    u8 wanted[8];
    u8 i;
    const u8 port = 1;
    u16 begin = clock_ticks();
    module_request(REMOTE_NAME, address, 6);
    if (!module_await(CONFIRM, REMOTE_NAME, &packet, SECONDS(20)) || packet.data[0] != 0 ||
        packet.data[7] < 11) {
        report("no name\r\n");
        return 0;
    }
    report("named ");
    for (i = 0; i < packet.data[7] && i < 40; ++i) report_byte(packet.data[8 + i]);
    report_time(" in", begin);
    for (i = 0; i < 4; ++i) wanted[i] = packet.data[15 + i];
    module_request(READ_PIN, &port, 0);
    module_await(CONFIRM, READ_PIN, &packet, SECONDS(1));
    for (i = 0; i < 4; ++i) own_pin[i] = packet.data[2 + i];
    write_pin(wanted);
    begin = clock_ticks();
    wanted[0] = wanted[7] = port;
    for (i = 0; i < 6; ++i) wanted[1 + i] = address[i];
    module_request(ESTABLISH_LINK, wanted, sizeof wanted);
    i = module_await(INDICATION, LINK_ESTABLISHED, &packet, SECONDS(60)) && packet.data[0] == 0;
    write_pin(own_pin);
    if (!i) {
        report("not linked\r\n");
        return 0;
    }
    report_time("linked in", begin);
    module_request(TRANSPARENT_MODE, &port, 1);
    module_await(CONFIRM, TRANSPARENT_MODE, &packet, SECONDS(1));
    return 1;
}

static void release(void) {
    const u8 port = 1;
    u16 begin;
    serial_break();
    module_await(INDICATION, TRANSPARENT_MODE, &packet, SECONDS(1));
    begin = clock_ticks();
    module_request(RELEASE_LINK, &port, 1);
    module_await(INDICATION, LINK_RELEASED, &packet, SECONDS(10));
    report_time("released in", begin);
}

u8 exchange(const char* line) {
    const u16 begin = clock_ticks();
    u8 address[6];
    serial_forget();
    if (!find(address)) {
        report("nobody found\r\n");
        return 0;
    }
    if (!link_with(address)) return 0;
    send_line(line);
    report(answered() ? "answered\r\n" : "no answer\r\n");
    release();
    report_time("exchange", begin);
    return 1;
}
