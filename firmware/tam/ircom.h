/* Infra-red words to and from the robot in the booth: 12 symbols of 2.6 ms, two MARKs, eight bits, two check bits; a MARK
   (0) is ten half periods of 260 us, a SPACE (1) five of 520 us (TAM fact sheet, section 8). */
#ifndef IRCOM_H
#define IRCOM_H

#include "types.h"

void ircom_start(void);
/* Begins a word, in the background; 0: one is on its way. */
u8 ircom_send(u8 word);
u8 ircom_sending(void);
/* 0: no good word has come in since. Nothing is received while a word is sent. */
u8 ircom_receive(u8 *word);
/* Words with a wrong check or begin, since the start. */
u16 ircom_errors(void);

#endif
