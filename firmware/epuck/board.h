/* The e-puck's pins and clock (fact sheet 3.1 and 3.2). */
#ifndef EPUCK_BOARD_H
#define EPUCK_BOARD_H

#define FCY 14745600UL /* 7.3728 MHz crystal, PLL x8, four clocks an instruction */

/* Ring LED i on port A, 0 is the front one, then clockwise; 1 = on */
#define LED0 (1 << 6)
#define LED1 (1 << 7)
#define LED2 (1 << 9)
#define LED3 (1 << 12)
#define LED4 (1 << 10)
#define LED5 (1 << 13)
#define LED6 (1 << 14)
#define LED7 (1U << 15)
#define RING_LEDS (LED0 | LED1 | LED2 | LED3 | LED4 | LED5 | LED6 | LED7)

/* Port C */
#define FRONT_LED (1 << 1)
#define BODY_LED (1 << 2)
#define CAMERA_RESET (1 << 13) /* active low */

/* Port D: phases A to D of the stepper motors */
#define LEFT_PHASES 0x000F
#define RIGHT_PHASES 0x00F0

/* Port F */
#define AUDIO_ON (1 << 0)
#define BATTERY_OK (1 << 1) /* input, 0 = below about 3.4 V */
#define PULSE0 (1 << 7)     /* infra-red emitters of sensors 0 and 4 */
#define PULSE1 (1 << 8)     /* 1 and 5 */

/* Port G */
#define PULSE2 (1 << 0) /* 2 and 6 */
#define PULSE3 (1 << 1) /* 3 and 7 */

/* Microphones right, left, rear are AN2..AN4, about mid scale; the accelerometer's x, y, z AN5..AN7 */
#define MICROPHONES 0x001C
#define ACCELEROMETER 0x00E0

/* Phototransistors 0..7 are AN8..AN15; more light gives a lower value */
#define PHOTOTRANSISTORS 0xFF00

/* Interrupt levels: the converter's results must be fetched before its next scan */
#define LEVEL_IRCOM 7
#define LEVEL_ADC 6
#define LEVEL_UART 5
#define LEVEL_MOTOR 4
#define LEVEL_CLOCK 3

#endif
