/* Sound on the e-puck: what the robot does follows from its selector.
 *   0  commands over UART1, as BTcom has them: T,n plays; U answers the three volumes; D,left,right drives
 *   1  plays sound 5 every five seconds
 *   2  walks at random and writes "I hear you" each time the mean of its volumes rises above 60 */

#include "../epuck/analog.h"
#include "../epuck/board.h"
#include "../epuck/clock.h"
#include "../epuck/leds.h"
#include "../epuck/microphones.h"
#include "../epuck/motors.h"
#include "../epuck/proximity.h"
#include "codec.h"
#include "console.h"
#include "registers.h"
#include "sounds.h"
#include "walk.h"

#define SELECTOR ((PORTG >> 6) & 15)
#define BODY 2 /* of leds_set() */

/* The number that follows the next comma; *text is left behind it. */
static s16 number(const char** text) {
    s16 value = 0;
    u8 negative = 0;
    while (**text != 0 && **text != ',') ++*text;
    if (**text == ',') ++*text;
    if (**text == '-') {
        negative = 1;
        ++*text;
    }
    while (**text >= '0' && **text <= '9') value = value * 10 + (*(*text)++ - '0');
    return negative ? -value : value;
}

static void obey(const char* line) {
    s16 left;
    u8 ear;
    switch (*line) {
    case 'T':
        sounds_play((u8)number(&line));
        CONSOLE_PUT3('t', '\r', '\n');
        break;
    case 'U':
        console_put('u');
        for (ear = 0; ear < EARS; ++ear) {
            console_put(',');
            console_number(volume(ear));
        }
        console_put('\r');
        console_put('\n');
        break;
    case 'D':
        left = number(&line);
        motors_set(left, number(&line));
        CONSOLE_PUT3('d', '\r', '\n');
        break;
    default: CONSOLE_PUT3('z', '\r', '\n');
    }
}

static void commands(void) {
    const char* const line = console_line();
    if (line != 0) obey(line);
}

/* Every five seconds. */
static void caller(void) {
    static u16 next;
    if ((s16)(clock_ticks() - next) < 0) return;
    next += 5 * TICKS_PER_SECOND;
    sounds_play(5);
}

#define LOUD (60 * EARS)
#define HOLD (2 * TICKS_PER_SECOND) /* a call is answered once: sound 5 lasts 1.1 s */

static void listener(void) {
    static u8 heard;
    static u16 until;
    const u16 now = clock_ticks();
    walk_step();
    if (heard && (s16)(now - until) < 0) return;
    if (heard) leds_set(0, 0);
    heard = volume(0) + volume(1) + volume(2) > LOUD;
    if (!heard) return;
    until = now + HOLD;
    leds_set(0, BODY);
    CONSOLE_PUT3('I', ' ', 'h');
    CONSOLE_PUT3('e', 'a', 'r');
    CONSOLE_PUT3(' ', 'y', 'o');
    CONSOLE_PUT3('u', '\r', '\n');
}

int main(void) {
    LATC &= ~CAMERA_RESET;
    TRISC &= ~CAMERA_RESET;
    leds_start();
    motors_start();
    clock_start();
    proximity_start();
    analog_start();
    console_start();
    codec_start();
    while (!proximity_ready()) IDLE();
    for (;;) {
        switch (SELECTOR) {
        case 1: caller(); break;
        case 2: listener(); break;
        default: commands();
        }
        IDLE();
    }
}
