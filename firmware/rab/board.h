/* The range-and-bearing board's pins and clock (fact sheet 1.3 and 1.4). */
#ifndef RAB_BOARD_H
#define RAB_BOARD_H

#define FCY 40000000UL /* 4 MHz crystal / 2 * 80 / 2, two clocks an instruction */

#define SENSORS 12
#define ALL_SENSORS 0x0FFF

/* Port A: bit 3 LED; peak resets 9..12 on bits 5, 4, 1, 0 */
#define RESETS_A 0x0033
#define LED (1 << 3)

/* Port B: gates of the infra-red emitters, 1 = emit; the potentiometer's chip select, 0 = selected */
#define EMITTERS 0xFF39
#define CHIP_SELECT (1 << 2)

/* Port D: demodulators 1..12 on bits 4..15, 0 = carrier seen */
#define FIRST_DEMODULATOR 4

/* Port F: peak resets 1, 2 on bits 0, 1; supply of the emitters */
#define RESETS_F 0x0003
#define EMITTER_SUPPLY (1 << 12)

/* Port G: peak resets 3, 4 on bits 0, 1 and 5..8 on bits 12..15 */
#define RESETS_G 0xF003

/* Peak detectors 1..12 are AN20..AN31 */
#define FIRST_PEAK_INPUT 20
#define PEAK_INPUTS_H 0xFFF0 /* in AD1PCFGH */

/* Interrupt levels: chips go out on time first, then comes sampling, then the I2C master that waits */
#define LEVEL_CHIP 6
#define LEVEL_SAMPLE 5
#define LEVEL_I2C 4
#define LEVEL_RECEIVER 3 /* and the A/D converter: they share data */
#define LEVEL_UART 2

/* The air: one chip is half a bit */
#define CHIP_CYCLES 3924 /* 98.1 us; the original firmware's mean is 98.085 us */
#define TICKS_PER_CHIP 10
#define TICK_CYCLES 392   /* 9.8 us, one look at the demodulators */
#define CARRIER_CYCLES 88 /* 454.5 kHz */
#define PREAMBLE_CHIPS 6
#define CHECK_BITS 4
#define MAX_BITS 32

#endif
