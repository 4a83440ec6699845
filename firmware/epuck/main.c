/* The e-puck main board's firmware: start everything, then serve the Linux board. */

#include "analog.h"
#include "board.h"
#include "clock.h"
#include "ircom.h"
#include "leds.h"
#include "motors.h"
#include "proximity.h"
#include "registers.h"
#include "session.h"
#include "uart.h"

/* Camera and sound are not used: held in reset. The I2C pins stay inputs, the bus is the Linux board's. */
static void quiet_the_rest(void) {
    LATC &= ~CAMERA_RESET;
    TRISC &= ~CAMERA_RESET;
    LATF &= ~AUDIO_ON;
    TRISF &= ~AUDIO_ON;
}

int main(void) {
    const u8 power_on = (RCON & (POR | BOR)) != 0;
    RCON &= ~RESET_CAUSES;
    quiet_the_rest();
    leds_start();
    motors_start();
    clock_start();
    proximity_start();
    analog_start();
    uart_start();
#ifdef IRCOM
    ircom_start();
#endif
    while (!proximity_ready())
        IDLE(); /* 13 ms; what Linux sends meanwhile is kept */
    session_start(!power_on);
    for (;;) {
#ifdef IRCOM
        ircom_step();
#endif
        session_step();
        IDLE();
    }
}
