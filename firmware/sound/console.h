/* UART1 at 115200 8N1: lines of text both ways. */
#ifndef SOUND_CONSOLE_H
#define SOUND_CONSOLE_H

#include "../epuck/types.h"

#define LINE 24 /* characters a line may have, its end included */

void console_start(void);
/* A line that has come in, without its end and with a 0 behind it, or null; valid until the next call. */
const char* console_line(void);
void console_put(char character);
/* No strings: a constant would need the program space window. */
#define CONSOLE_PUT3(a, b, c) (console_put(a), console_put(b), console_put(c))
void console_number(s16 value);

#endif
