#include "commands.h"

#include "frames.h"
#include "potentiometer.h"

static u32 payloads[SENSORS];
static u16 armed;
static volatile u8 raw;
static volatile u8 uart;

static void set_bits(u8 bits) {
    frames_set_bits(bits);
    if (frames_bits() == bits) receiver_set_bits(bits);
}

void command_obey(u8 command, u32 value) {
    switch (command) {
    case SET_RANGE:
        potentiometer_want(value);
        break;
    case SEND_ALL:
        armed = 0;
        frames_send_all(value);
        break;
    case SEND_EACH:
        frames_send_each(armed, payloads);
        armed = 0;
        break;
    case MEASURE_DARK:
        receiver_measure_dark();
        break;
    case SET_RAW:
        raw = value != 0;
        break;
    case SET_UART:
        uart = value != 0;
        break;
    case SET_BITS:
        set_bits(value);
        break;
    default:
        if (command >= SENSORS) break;
        payloads[command] = value;
        armed |= 1 << command;
    }
}

u8 command_raw(void) {
    return raw;
}
u8 command_uart(void) {
    return uart;
}
