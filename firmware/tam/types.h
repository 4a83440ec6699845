/* Short names for the integers of a stated width. */
#ifndef TYPES_H
#define TYPES_H

typedef unsigned char u8;
typedef unsigned int u16; /* int has 16 bits */
typedef unsigned long u32;
typedef signed int s16;
typedef signed char s8;

#endif
