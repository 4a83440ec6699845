/* A random walk that keeps clear of what the proximity sensors see. */
#ifndef SOUND_WALK_H
#define SOUND_WALK_H

/* Sets the motors; to be called every few milliseconds. */
void walk_step(void);
void walk_stop(void);

#endif
