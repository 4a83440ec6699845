/* Five calls as long as the e-puck library's predefined sounds. Each is a voice of three harmonics whose pitch
 * slides from one tone to another. */
#ifndef SOUND_SOUNDS_H
#define SOUND_SOUNDS_H

#include "../epuck/types.h"

#define SOUNDS 5

/* Plays sound 1..SOUNDS from its beginning; any other number is silence. */
void sounds_play(u8 number);
u8 sounds_playing(void);
/* The next sample at 7200 Hz. */
s16 sounds_sample(void);

#endif
