#include "coordinator.h"

#include "board.h"
#include "booth.h"
#include "clock.h"
#include "leds.h"
#include "radio.h"
#include "registers.h"
#include "uart.h"

#define FIRST_NETWORK 0x01B2 /* and three more, by the switches */
#define READY_MS 2000        /* the module reports within so long after a reset, or not at all */
#define SEARCH_MS 5000       /* between two searches for the coordinator */
#define BLINK_MS 500
#define HEARTBEAT_MS 10000
#define TIMEOUT_MS 1000      /* of an acknowledgement */
#define MOST_FAILURES 10     /* reports in a row that nobody took: look for the coordinator again */

#define REPORT 0x00
#define SET_LEDS 0x0A
#define WRITE_ROBOT 0x0C
#define SHUTDOWN 0x0D
#define DATA_AT 12 /* of a frame 90: type, address (8), network (2), option */

struct state {
    u8 red, green, blue, present, robot;
};

static enum { WAITING, SEARCHING, JOINED } phase;
static u32 since;       /* of the phase's last step */
static u8 address[8];
static struct state now, acknowledged, sent;
static u8 forced, word, says_off;
static u8 outstanding;  /* id of the report that is not acknowledged, 0: none */
static u32 sent_at, heartbeat;
static u8 failures;

static void search(void) {
    static const u8 name[] = {'C', 'O', 'O', 'R', 'D'};
    radio_command("DN", name, sizeof name);
    since = clock_ms();
}

static void join(void) {
    const u8 switches = (u8)((PINB & XBEE_NET_0 ? 2 : 0) + (PINB & XBEE_NET_1 ? 1 : 0));
    const u16 network = FIRST_NETWORK + switches;
    u8 id[2];
    id[0] = network >> 8;
    id[1] = (u8)network;
    radio_command("ID", id, sizeof id);
    print("network ");
    print_number(network);
    print("\r\n");
    phase = SEARCHING;
    search();
}

void coordinator_start(void) {
    PORTB |= XBEE_NET_0 | XBEE_NET_1; /* pull-ups */
    DDRC |= NETWORK_LED;
    radio_reset();
    phase = WAITING;
    since = clock_ms();
}

static u8 same(const struct state *a, const struct state *b) {
    return a->red == b->red && a->green == b->green && a->blue == b->blue && a->present == b->present &&
           a->robot == b->robot;
}

static void report(void) {
    const u16 battery = booth_battery_mv();
    u8 payload[8];
    payload[0] = REPORT;
    payload[1] = now.red;
    payload[2] = now.green;
    payload[3] = now.blue;
    payload[4] = now.present;
    payload[5] = (u8)battery;
    payload[6] = battery >> 8;
    payload[7] = now.robot;
    sent = now;
    outstanding = radio_send(address, payload, sizeof payload);
    sent_at = heartbeat = clock_ms();
    forced = 0;
}

/* ---- what comes in ---- */

static void found(const struct frame *frame) {
    /* DN answers with the 16-bit and the 64-bit address; the status' upper half is flags. */
    u8 i;
    if (frame->length < 15 || frame->data[2] != 'D' || frame->data[3] != 'N' || (frame->data[4] & 0x0F)) return;
    for (i = 0; i < sizeof address; ++i)
        address[i] = frame->data[7 + i];
    if (phase != JOINED) {
        print("coordinator found\r\n");
        heartbeat = clock_ms();
        forced = 1;
    }
    phase = JOINED;
    failures = 0;
    PORTC |= NETWORK_LED;
}

static void obey(const u8 *payload, u8 length) {
    if (length >= 4 && payload[0] == SET_LEDS) {
        now.red = payload[1];
        now.green = payload[2];
        now.blue = payload[3];
        leds_colour(now.red, now.green, now.blue);
        forced = 1;
    } else if (length >= 2 && payload[0] == WRITE_ROBOT) {
        word = payload[1];
    } else if (length >= 1 && payload[0] == SHUTDOWN) {
        says_off = 1;
    }
}

static void delivered(const struct frame *frame) {
    if (frame->length < 6 || frame->data[1] != outstanding) return;
    if (frame->data[5] == 0) {
        acknowledged = sent;
        outstanding = 0;
        failures = 0;
    } /* else the time-out is waited for */
}

static void receive(void) {
    struct frame frame;
    while (radio_receive(&frame)) {
        switch (frame.data[0]) {
        case RADIO_AT_RESPONSE:
            found(&frame);
            break;
        case RADIO_TX_STATUS:
            delivered(&frame);
            break;
        case RADIO_RX:
            if (frame.length > DATA_AT) obey(&frame.data[DATA_AT], frame.length - DATA_AT);
            break;
        case RADIO_MODEM_STATUS:
            if (phase != WAITING) forced = 1; /* it was reset behind our back */
            join();
            break;
        }
    }
}

/* ---- what goes out ---- */

static void lose(void) {
    outstanding = 0;
    if (++failures < MOST_FAILURES) return;
    failures = 0;
    phase = SEARCHING;
    search();
}

static void keep_reporting(void) {
    now.present = booth_present();
    if (outstanding) {
        if (clock_passed(sent_at, TIMEOUT_MS)) lose();
        return;
    }
    if (forced || !same(&now, &acknowledged) || clock_passed(heartbeat, HEARTBEAT_MS)) report();
}

void coordinator_step(void) {
    receive();
    switch (phase) {
    case WAITING:
        if (clock_passed(since, READY_MS)) join();
        break;
    case SEARCHING:
        if (clock_ms() / BLINK_MS & 1) PORTC |= NETWORK_LED;
        else PORTC &= ~NETWORK_LED;
        if (clock_passed(since, SEARCH_MS)) search();
        break;
    case JOINED:
        keep_reporting();
        break;
    }
}

u8 coordinator_says_off(void) {
    return says_off;
}

u8 coordinator_word(void) {
    return word;
}

void coordinator_robot_says(u8 robot) {
    now.robot = robot;
}
