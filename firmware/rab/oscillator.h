#ifndef RAB_OSCILLATOR_H
#define RAB_OSCILLATOR_H

/* From the internal oscillator to crystal and PLL, 40 million instructions a second. Waits for the crystal.
 */
void oscillator_start(void);

#endif
