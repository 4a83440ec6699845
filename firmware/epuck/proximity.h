/* Proximity and ambient light: the emitters of one pair of opposite sensors are pulsed in turn, and the value
 * in the scan just before the pulse and in the one at its end are kept. A round of four pairs takes 13.10 ms. */
#ifndef EPUCK_PROXIMITY_H
#define EPUCK_PROXIMITY_H

#include "types.h"

#define SENSORS 8

void proximity_start(void);
/* By the converter's interrupt. */
void proximity_scanned(void);
#ifdef IRCOM
/* While held no pulse begins; one that is lit is finished. */
void proximity_hold(u8 held);
/* The pair whose emitters are lit, 0..3, or PROXIMITY_DARK. */
u8 proximity_lit(void);
#define PROXIMITY_DARK 0xFF
#endif
/* 0 until the first round is complete. */
u8 proximity_ready(void);
/* Ambient minus lit, ADC counts; more than 0 where something reflects. */
s16 proximity(u8 sensor);
/* Raw ambient value, 0..4095, bright is small. */
s16 ambient(u8 sensor);

#endif
