/* The range-and-bearing board's firmware: start everything, then turn requests into frames and receptions
 * into messages. Chips, samples, edges, registers and bytes are the interrupts' work. */

#include "bearing.h"
#include "board.h"
#include "commands.h"
#include "emitter.h"
#include "frames.h"
#include "messages.h"
#include "oscillator.h"
#include "peaks.h"
#include "potentiometer.h"
#include "receiver.h"
#include "registers.h"
#include "registers_i2c.h"
#include "sampler.h"
#include "serial.h"
#include "uart.h"

static void measure_first_dark(void) {
    receiver_measure_dark();
    while (receiver_measuring_dark())
        IDLE(); /* 2.3 ms with a free air, 53 ms without */
}

/* Waits after frames differ from board to board and from start to start. */
static u16 seed(void) {
    u16 sum = sampler_tick();
    u8 i;
    for (i = 0; i < SENSORS; ++i)
        sum = (sum << 3 | sum >> 13) ^ peak_raw(i);
    return sum;
}

static void pass_on_reception(void) {
    struct reception reception;
    struct message message;
    if (!receiver_take(&reception)) return;
    if (command_raw()) {
        registers_put_raw(&reception);
        return;
    }
    message.payload = reception.payload;
    find_place(reception.peak, &message.place);
    if (command_uart()) {
        serial_send_message(&message);
    } else {
        messages_put(&message);
    }
}

int main(void) {
    oscillator_start();
    LATA &= ~LED;
    TRISA &= ~LED;
    LATB = CHIP_SELECT;
    TRISB = ~(EMITTERS | CHIP_SELECT);
    potentiometer_start();
    registers_start();
    uart_start();
    peaks_start();
    sampler_start();
    receiver_start();
    measure_first_dark();
    emitter_start(seed());
    serial_announce();
    for (;;) {
        frames_build();
        potentiometer_step();
        pass_on_reception();
        serial_step();
        IDLE();
    }
}
