/* IRcom: words of one byte by the proximity sensors' light, to and from other robots and TAMs; only in the image
 * epuck_ircom.hex. The format: protocols/ircom.h. Sending is timer 2 that toggles all emitters; receiving is a
 * record of all phototransistors' scans in which a word is looked for. One at a time: who sends does not hear. */
#ifndef EPUCK_IRCOM_H
#define EPUCK_IRCOM_H

#include "types.h"

struct ircom_word {
    u8 data;
    u8 sensor;    /* that saw it brightest, 0..7 */
    s16 strength; /* counts between dark and light */
};

void ircom_start(void);
/* Sends the word when the one before is out and nothing is coming in; a later one takes its place until then. */
void ircom_send(u8 word);
/* 1 and the newest word, once; 0 if none came since. */
u8 ircom_receive(struct ircom_word *word);
/* By the converter's interrupt, before proximity_scanned(). */
void ircom_scanned(void);
/* In the main loop: looks for words, begins to send. */
void ircom_step(void);

#endif
