#include "oscillator.h"

#include "board.h"
#include "registers.h"

#define PLL_FACTOR 80

void oscillator_start(void) {
    PLLFBD = PLL_FACTOR - 2;
    CLKDIV = 0; /* PLLPRE and PLLPOST / 2 */
    /* Each half of OSCCON opens for one write after its two keys. */
    __asm__ volatile("mov #0x743, w1\n\t" /* OSCCONH */
                     "mov #0x78, w2\n\t"
                     "mov #0x9A, w3\n\t"
                     "mov #0x03, w0\n\t" /* NOSC: crystal with PLL */
                     "mov.b w2, [w1]\n\t"
                     "mov.b w3, [w1]\n\t"
                     "mov.b w0, [w1]\n\t"
                     "mov #0x742, w1\n\t" /* OSCCONL */
                     "mov #0x46, w2\n\t"
                     "mov #0x57, w3\n\t"
                     "mov #0x01, w0\n\t" /* OSWEN */
                     "mov.b w2, [w1]\n\t"
                     "mov.b w3, [w1]\n\t"
                     "mov.b w0, [w1]"
                     :
                     :
                     : "w0", "w1", "w2", "w3", "memory");
    while ((OSCCON & COSC) != COSC_PRIMARY_PLL)
        ;
}
