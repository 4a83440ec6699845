/* What the driver programs share: numbers that the test drew, results that it reads, and the end. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdint.h>

/* Written by the test before the program starts: the C start-up leaves it alone. */
extern volatile uint8_t input[32];
extern volatile uint8_t result[64];
extern volatile uint16_t stamps[32];

/* The test stops here. */
void finished(void);

#define DRIVER                                                          \
    volatile uint8_t input[32] __attribute__((section(".noinit")));     \
    volatile uint8_t result[64];                                        \
    volatile uint16_t stamps[32];                                       \
    void __attribute__((noinline)) finished(void) {                     \
        for (;;)                                                        \
            __asm__ __volatile__("");                                   \
    }
