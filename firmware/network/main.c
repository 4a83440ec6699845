/* A team's robot: wanders, keeps clear of walls and others, and says hello to everybody every five seconds.
 * The selector chooses how: from 10 on by WiFi (packets go to UART2, where the Linux board's puckloop-forward
 * passes them on), below by Bluetooth. A packet whose data begin with '?' is answered to its sender with '!'.
 * Ring LED 0 changes with each packet that came; the body LED is lit after a receive call that gave up. */

#include "../bluetooth/exchange.h"
#include "../bluetooth/serial.h"
#include "../epuck/analog.h"
#include "../epuck/board.h"
#include "../epuck/clock.h"
#include "../epuck/leds.h"
#include "../epuck/motors.h"
#include "../epuck/proximity.h"
#include "../epuck/registers.h"
#include "../sound/walk.h"
#include "network.h"

SFR(PORTG, 0x2E6);
#define SELECTOR ((PORTG >> 6) & 15)
#define WIFI_FROM 10
#define HELLO_EVERY SECONDS(5)
#define BODY 2 /* of leds_set() */

static u8 wifi;

static void leds(u8 changed, u8 silent) {
    static u8 ring;
    ring ^= changed;
    leds_set(ring, silent ? BODY : 0);
}

/* A time within the period, so that a team's robots do not speak in chorus: from the noise of the converter,
 * through a shift register of 16 bits (taps 16, 14, 13, 11). */
static u16 phase(void) {
    u16 bits = 1;
    u8 i;
    for (i = 0; i < 16; ++i) {
        const u16 begin = clock_ticks();
        while ((u16)(clock_ticks() - begin) < 15)
            IDLE(); /* a round of the proximity sensors */
        bits ^= (u16)ambient(i & 7) << (i & 7);
        bits = (bits >> 1) ^ (bits & 1 ? 0xB400 : 0);
    }
    while (bits >= HELLO_EVERY)
        bits -= HELLO_EVERY;
    return bits;
}

#define DIGITS 5

static void say_hello(void) {
    static u16 count; /* 0 to 65535 */
    static u8 data[6 + DIGITS];
    static const char hello[] = "hello ";
    u16 rest = count++;
    u8 i;
    for (i = 0; i < 6; ++i)
        data[i] = (u8)hello[i];
    for (i = 6 + DIGITS; i-- > 6; rest /= 10)
        data[i] = '0' + (u8)(rest % 10);
    if (!wifi) walk_stop(); /* by Bluetooth that takes some 20 s, in which nobody steers */
    network_send(EVERYBODY, data, sizeof data);
}

static void take(struct NetworkPacket* packet) {
    u8 i;
    leds(1, 0);
    if (packet->length != 0 && packet->data[0] == '?') {
        packet->data[0] = '!';
        if (!wifi) walk_stop();
        network_send(packet->number, packet->data, packet->length);
    }
    if (wifi) return; /* UART2 has packets only */
    report("heard ");
    report_number(packet->number);
    report_byte(' ');
    for (i = 0; i < packet->length; ++i)
        report_byte(packet->data[i]);
    report("\r\n");
}

int main(void) {
    u16 last;
    LATC &= ~CAMERA_RESET;
    TRISC &= ~CAMERA_RESET;
    leds_start();
    motors_start();
    clock_start();
    proximity_start();
    analog_start();
    while (!proximity_ready())
        IDLE();
    wifi = SELECTOR >= WIFI_FROM;
    pause(SECONDS(2)); /* Bluetooth module and Linux board's program are ready by then */
    network_start(wifi, walk_step);
    last = clock_ticks() - phase();
    for (;;) {
        static struct NetworkPacket packet;
        const u16 passed = clock_ticks() - last;
        if (passed >= HELLO_EVERY) {
            say_hello();
            last = wifi ? last + HELLO_EVERY : clock_ticks();
            continue;
        }
        if (network_receive(&packet, HELLO_EVERY - passed))
            take(&packet);
        else if (HELLO_EVERY - passed >= RECEIVE_TIMEOUT)
            leds(0, 1);
    }
}
