#include "motors.h"

#include "board.h"
#include "registers.h"

/* Coil patterns of the four phases, phase 0 in the low nibble: 1010, 0110, 0101, 1001 (D C B A). */
#define PATTERNS 0x956AU
#define SLOW 4 /* steps/s below which the finer prescaler cannot reach */

static volatile u8 left_phase;
static volatile u8 right_phase;
static volatile u8 left_forward;
static volatile u8 right_forward;
static s16 left_speed;
static s16 right_speed;

static u16 pattern(u8 phase) {
    return (PATTERNS >> (phase << 2)) & 0xF;
}

void INTERRUPT _T5Interrupt(void) {
    IFS1 &= ~T5IF;
    left_phase = (left_forward ? left_phase - 1 : left_phase + 1) & 3;
    LATD = (LATD & ~LEFT_PHASES) | pattern(left_phase);
}

void INTERRUPT _T4Interrupt(void) {
    IFS1 &= ~T4IF;
    right_phase = (right_forward ? right_phase + 1 : right_phase - 1) & 3;
    LATD = (LATD & ~RIGHT_PHASES) | pattern(right_phase) << 4;
}

void motors_start(void) {
    LATD &= ~(LEFT_PHASES | RIGHT_PHASES);
    TRISD &= ~(LEFT_PHASES | RIGHT_PHASES);
    IPC5 = (IPC5 & ~(IP_MASK(T4IP) | IP_MASK(T5IP))) | T4IP(LEVEL_MOTOR) | T5IP(LEVEL_MOTOR);
    IEC1 |= T4IF | T5IF;
}

static s16 clamp(s16 speed) {
    if (speed > MAXIMUM_SPEED) return MAXIMUM_SPEED;
    if (speed < -MAXIMUM_SPEED) return -MAXIMUM_SPEED;
    return speed;
}

/* Timer counts of a step, rounded; *control gets the prescaler that fits. */
static u16 period(u16 speed, u16* control) {
    u32 clock = FCY / 64;
    *control = TON | TCKPS_64;
    if (speed < SLOW) {
        clock = FCY / 256;
        *control = TON | TCKPS_256;
    }
    return __builtin_divud(clock + speed / 2, speed);
}

/* The timer goes on from where it is when only the speed changes, so that a stream of changing commands
 * cannot hold a motor back; a count beyond the new period is taken back to it. */
#define PROGRAM(timer, compare, control_register, speed)                                                     \
    do {                                                                                                     \
        u16 control;                                                                                         \
        const u16 counts = period(speed, &control);                                                          \
        if (control_register != control) {                                                                   \
            control_register = 0;                                                                            \
            timer = 0;                                                                                       \
        }                                                                                                    \
        compare = counts - 1;                                                                                \
        if (timer >= counts - 1) timer = counts - 2;                                                         \
        control_register = control;                                                                          \
    } while (0)

static void set_left(s16 speed) {
    if (speed == left_speed) return;
    left_speed = speed;
    if (speed == 0) {
        T5CON = 0;
        IFS1 &= ~T5IF;
        __builtin_disi(6); /* the right motor's interrupt writes the same port */
        LATD &= ~LEFT_PHASES;
        return;
    }
    left_forward = speed > 0;
    PROGRAM(TMR5, PR5, T5CON, speed > 0 ? speed : -speed);
}

static void set_right(s16 speed) {
    if (speed == right_speed) return;
    right_speed = speed;
    if (speed == 0) {
        T4CON = 0;
        IFS1 &= ~T4IF;
        __builtin_disi(6);
        LATD &= ~RIGHT_PHASES;
        return;
    }
    right_forward = speed > 0;
    PROGRAM(TMR4, PR4, T4CON, speed > 0 ? speed : -speed);
}

void motors_set(s16 left, s16 right) {
    set_left(clamp(left));
    set_right(clamp(right));
}
