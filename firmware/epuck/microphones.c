#include "microphones.h"

#include "analog.h"

#define FIRST_MICROPHONE 2 /* AN2, the others follow */
#define WINDOW 100         /* samples, as in the e-puck library's buffer */

static volatile s16 volume_value[EARS];
static s16 largest[EARS];
static s16 smallest[EARS];
static u8 samples;

void microphones_scanned(void) {
    const u8 last = samples == WINDOW - 1;
    u8 ear;
    for (ear = 0; ear < EARS; ++ear) {
        const s16 sample = ANALOG(FIRST_MICROPHONE + ear);
        if (samples == 0 || sample > largest[ear]) largest[ear] = sample;
        if (samples == 0 || sample < smallest[ear]) smallest[ear] = sample;
        if (last) volume_value[ear] = largest[ear] - smallest[ear];
    }
    samples = last ? 0 : samples + 1;
}

s16 volume(u8 ear) {
    return volume_value[ear];
}
