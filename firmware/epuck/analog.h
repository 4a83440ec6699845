/* The A/D converter scans the microphones, the accelerometer and the phototransistors without pause, 142.4 us
 * a scan; its interrupt hands each scan to those who want it. */
#ifndef EPUCK_ANALOG_H
#define EPUCK_ANALOG_H

#include "registers.h"

#define FIRST_CHANNEL 2 /* AN2 */
#define CHANNELS 14     /* to AN15 */

/* Input ANi of the newest scan; to be read within the interrupt. */
#define ANALOG(an) ((s16)(&ADCBUF0)[(an)-FIRST_CHANNEL])

void analog_start(void);

#endif
