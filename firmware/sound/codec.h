/* The Si3000 codec on the DCI plays 7200 samples a second. */
#ifndef SOUND_CODEC_H
#define SOUND_CODEC_H

/* Needs sounds.c, which is asked for each sample within the DCI's interrupt. */
void codec_start(void);

#endif
