/* Fixed-width integers of the pic30 compiler, whose int has 16 bits; no C library is used. */
#ifndef RAB_TYPES_H
#define RAB_TYPES_H

typedef unsigned char u8;
typedef unsigned int u16;
typedef unsigned long u32;
typedef signed int s16;
typedef signed long s32;

#endif
