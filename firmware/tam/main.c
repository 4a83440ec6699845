/* The TAM's firmware: a booth that a coordinator colours and a robot enters. */

#include "board.h"
#include "booth.h"
#include "clock.h"
#include "coordinator.h"
#include "ircom.h"
#include "leds.h"
#include "radio.h"
#include "registers.h"
#include "uart.h"

#define WORD_EVERY_MS 200 /* to a robot that is present */
#define FAREWELL_MS 500
#define STATUS_MS 10000

static void watchdog_start(void) {
    CLI();
    WDR();
    MCUSR = 0;
    WDTCSR = WDCE | 0x08;
    WDTCSR = WDE_1S;
}

static void switch_off(const char *why) {
    print(why);
    leds_colour(0, 0, 0);
    clock_wait(FAREWELL_MS);
    PORTB |= PWR_CLEAR;
    for (;;)
        clock_wait(1000); /* on a cable's supply the booth lives on */
}

static void talk_to_robot(void) {
    static u32 sent;
    u8 word;
    if (booth_present() && !ircom_sending() && clock_passed(sent, WORD_EVERY_MS)) {
        ircom_send(coordinator_word());
        sent = clock_ms();
    }
    if (ircom_receive(&word) && booth_present()) coordinator_robot_says(word);
}

static void print_value(const char *name, u16 value) {
    print(name);
    print_number(value);
}

static void print_status(void) {
    static u32 printed;
    if (!clock_passed(printed, STATUS_MS)) return;
    printed = clock_ms();
    print_value("battery ", booth_battery_mv());
    print_value(" mV, damaged frames ", radio_errors());
    print_value(", bad infra-red words ", ircom_errors());
    print_value(", failed LED transfers ", leds_failures());
    print("\r\n");
}

int main(void) {
    watchdog_start();
    DDRB = PROX_EMIT | PWR_CLEAR;
    SMCR = SLEEP_ENABLE;
    clock_start();
    uart_start();
    SEI();
    print("puckloop TAM firmware\r\n");
    if (!leds_start()) print("LED driver does not answer\r\n");
    booth_start();
    ircom_start();
    coordinator_start();
    for (;;) {
        WDR();
        booth_step();
        talk_to_robot();
        coordinator_step();
        print_status();
        if (coordinator_says_off()) switch_off("switched off by the coordinator\r\n");
        if (booth_exhausted()) switch_off("battery empty\r\n");
        SLEEP();
    }
}
