/* Ears and radio: what the robot does follows from its selector.
 *   0  calls: plays sound 5 every five seconds. A message by Bluetooth is written to UART2 and answered; the
 *      next call comes five seconds after the link is released
 *   1  walks at random; each time the mean of its three volumes exceeds 60 it stands still and sends "I hear
 *      you" by Bluetooth to the first e-puck that it finds, then it walks on. UART2 has what became of it */

#include "../bluetooth/exchange.h"
#include "../bluetooth/serial.h"
#include "../epuck/analog.h"
#include "../epuck/board.h"
#include "../epuck/clock.h"
#include "../epuck/leds.h"
#include "../epuck/microphones.h"
#include "../epuck/motors.h"
#include "../epuck/proximity.h"
#include "../sound/codec.h"
#include "../sound/registers.h"
#include "../sound/sounds.h"
#include "../sound/walk.h"

#define SELECTOR ((PORTG >> 6) & 15)
#define LED_LINKED 0x01
#define BODY 2 /* of leds_set() */
#define LOUD (60 * EARS)
#define CALL_EVERY SECONDS(5)

static void call(void) {
    static u16 last;
    static u8 linked;
    const u16 now = clock_ticks();
    switch (listen()) {
    case LISTEN_LINKED:
        linked = 1;
        leds_set(LED_LINKED, 0);
        break;
    case LISTEN_RELEASED:
        linked = 0;
        last = now;
        leds_set(0, 0);
        break;
    }
    if (linked || (u16)(now - last) < CALL_EVERY) return;
    last = now;
    sounds_play(5);
}

static void hear(void) {
    const s16 sum = volume(0) + volume(1) + volume(2);
    walk_step();
    if (sum <= LOUD) return;
    walk_stop();
    leds_set(0, BODY);
    report("hears ");
    report_number((u32)(sum / EARS));
    report("\r\n");
    exchange("I hear you");
    leds_set(0, 0);
    report("walks\r\n");
}

int main(void) {
    LATC &= ~CAMERA_RESET;
    TRISC &= ~CAMERA_RESET;
    leds_start();
    motors_start();
    clock_start();
    proximity_start();
    analog_start();
    serial_start();
    codec_start();
    while (!proximity_ready()) IDLE();
    pause(SECONDS(2)); /* the module is ready by then */
    if (SELECTOR != 0) report("walks\r\n");
    for (;;) {
        if (SELECTOR == 0)
            call();
        else
            hear();
        IDLE();
    }
}
