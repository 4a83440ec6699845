/* The peak detectors behind the twelve sensors: reset lines, A/D converter, and what they read in the dark.
 */
#ifndef RAB_PEAKS_H
#define RAB_PEAKS_H

#include "board.h"
#include "types.h"

void peaks_start(void);

/* Discharges these detectors from now on, and no others. */
void peaks_reset(u16 sensors);

/* Asks for readings; they come within 12 x 7 us. Level LEVEL_RECEIVER. */
void peaks_read(u16 sensors);
/* Sensors whose reading has not come yet. */
u16 peaks_awaited(void);
/* The newest reading, A/D counts. */
u16 peak_raw(u8 sensor);
/* The same above what the sensor reads in the dark, 0 or more. */
u16 peak_above_dark(u8 sensor);

/* Takes the newest readings for darkness. */
void peaks_set_dark(void);
u16 peak_dark(u8 sensor);

#endif
