#include "network.h"

#include "../epuck/clock.h"
#include "../epuck/registers.h"
#include "../epuck/uart.h"
#include "radio.h"

static u8 by_wifi;
static Background in_background;
static struct Line incoming;

static void wait(void) {
    in_background();
    IDLE();
}

void network_start(u8 wifi, Background background) {
    by_wifi = wifi;
    in_background = background;
    if (!wifi) radio_start();
    uart_start(); /* by Bluetooth it has reports */
}

static u8 send_by_uart(u16 to, const u8* data, u8 length) {
    static u8 line[PACKET_LINE];
    while (uart_sending())
        wait();
    uart_send(line, packet_write(line, to, data, length));
    return 1;
}

static u8 receive_by_uart(struct NetworkPacket* packet) {
    u16 entry;
    uart_listen();
    while ((entry = uart_receive()) != UART_NOTHING) {
        if (entry & UART_BAD) packet_spoil(&incoming);
        if (packet_take(&incoming, (u8)entry, packet)) return 1;
    }
    return 0;
}

u8 network_send(u16 to, const u8* data, u8 length) {
    return by_wifi ? send_by_uart(to, data, length) : radio_send(to, data, length);
}

u8 network_receive(struct NetworkPacket* packet, u16 ticks) {
    const u16 begin = clock_ticks();
    if (ticks > RECEIVE_TIMEOUT) ticks = RECEIVE_TIMEOUT;
    do {
        if (by_wifi ? receive_by_uart(packet) : radio_receive(packet)) return 1;
        wait();
    } while ((u16)(clock_ticks() - begin) < ticks);
    return 0;
}
