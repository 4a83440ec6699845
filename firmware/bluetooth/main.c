/* Two e-pucks talk by Bluetooth. Selector at 0: the robot listens, writes to UART2 what it hears, answers
 * "yes". At any other position it calls: looks for e-pucks, links with the first, says "I hear you", waits
 * for the answer, releases, and writes to UART2 how long each took; again after 5 s. */

#include "../epuck/board.h"
#include "../epuck/clock.h"
#include "../epuck/leds.h"
#include "../epuck/registers.h"
#include "exchange.h"
#include "serial.h"

SFR(PORTG, 0x2E6);
#define SELECTOR() (PORTG >> 6 & 15)

#define LED_LINKED 0x01
#define LED_CALLING 0x10

static void answer(void) {
    for (;;) {
        switch (listen()) {
        case LISTEN_LINKED: leds_set(LED_LINKED, 0); break;
        case LISTEN_RELEASED: leds_set(0, 0); break;
        case LISTEN_NOTHING: IDLE(); break;
        }
    }
}

static void call(void) {
    leds_set(LED_CALLING, 0);
    exchange("I hear you");
    leds_set(0, 0);
    pause(SECONDS(5));
}

int main(void) {
    ADPCFG = 0xFFFF; /* all pins digital */
    leds_start();
    clock_start();
    serial_start();
    pause(SECONDS(2)); /* the module is ready by then */
    if (SELECTOR() == 0) answer();
    for (;;) call();
}
