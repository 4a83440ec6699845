#include "radio.h"

#include "board.h"
#include "clock.h"
#include "registers.h"
#include "uart.h"

#define START 0x7E
#define ESCAPE 0x7D
#define FLIP 0x20
#define RESET_MS 120
#define AT_COMMAND 0x08
#define AT_ID 1
#define TX_REQUEST 0x10

enum { IDLE, LENGTH_HIGH, LENGTH_LOW, DATA };

static u8 state = IDLE, escaped, sum, to_come;
static struct frame taking;
static u16 errors;
static u8 sum_sent;

void radio_reset(void) {
    PORTC &= ~XBEE_RTS;
    DDRC |= XBEE_RTS;
    PORTD &= ~XBEE_WAKE;
    DDRD |= XBEE_WAKE | XBEE_RST; /* CTS stays an input: it is the module's output */
    PORTD |= XBEE_RST;
    clock_wait(RESET_MS);
    PORTD &= ~XBEE_RST;
}

/* ---- in ---- */

static void damaged(void) {
    ++errors;
    state = IDLE;
}

/* True when `byte` completes a good frame. */
static u8 take(u8 byte) {
    if (byte == START) { /* wherever it comes: a frame begins */
        if (state != IDLE) damaged();
        state = LENGTH_HIGH;
        escaped = 0;
        return 0;
    }
    if (state == IDLE) return 0;
    if (byte == ESCAPE) {
        escaped = 1;
        return 0;
    }
    if (escaped) byte ^= FLIP;
    escaped = 0;
    switch (state) {
    case LENGTH_HIGH:
        if (byte) damaged();
        else state = LENGTH_LOW;
        break;
    case LENGTH_LOW:
        to_come = byte;
        taking.length = sum = 0;
        if (byte == 0) damaged();
        else state = DATA;
        break;
    default:
        sum += byte;
        if (to_come-- == 0) { /* the check */
            if (sum != 0xFF || taking.length > RADIO_MOST) damaged();
            else {
                state = IDLE;
                return 1;
            }
            break;
        }
        if (taking.length < RADIO_MOST) taking.data[taking.length] = byte;
        if (taking.length <= RADIO_MOST) ++taking.length;
        break;
    }
    return 0;
}

u8 radio_receive(struct frame *frame) {
    u8 byte;
    if (uart_broken(RADIO) && state != IDLE) damaged();
    while (uart_receive(RADIO, &byte))
        if (take(byte)) {
            *frame = taking;
            return 1;
        }
    return 0;
}

/* ---- out ---- */

static void put(u8 byte) {
    sum_sent += byte;
    if (byte == START || byte == ESCAPE || byte == 0x11 || byte == 0x13) {
        uart_send(RADIO, ESCAPE);
        byte ^= FLIP;
    }
    uart_send(RADIO, byte);
}

static void put_all(const u8 *bytes, u8 count) {
    while (count--)
        put(*bytes++);
}

static void begin(u8 type, u8 length) {
    uart_send(RADIO, START);
    put(0);
    put(length);
    sum_sent = 0;
    put(type);
}

static void end(void) {
    put(0xFF - sum_sent);
}

void radio_command(const char *command, const u8 *value, u8 length) {
    begin(AT_COMMAND, length + 4);
    put(AT_ID);
    put((u8)command[0]);
    put((u8)command[1]);
    put_all(value, length);
    end();
}

u8 radio_send(const u8 *address, const u8 *payload, u8 length) {
    static u8 id;
    static const u8 network[] = {0xFF, 0xFE, 0, 0}; /* 16-bit address unknown, any radius, no options */
    if (++id == 0) id = 1;
    begin(TX_REQUEST, length + 14);
    put(id);
    put_all(address, 8);
    put_all(network, sizeof network);
    put_all(payload, length);
    end();
    return id;
}

u16 radio_errors(void) {
    return errors;
}
