/* What avr-gcc and avr-libc make of ordinary C: floats, 64-bit division, printf, sorting, tables in flash, recursion.
   Everything is printed into RAM, so that a simulator without serial timing gives the same cycles. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/pgmspace.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char output[6000];
volatile uint16_t output_length;

static int put(char c, FILE *stream) {
    (void)stream;
    if (output_length < sizeof output) output[output_length++] = c;
    return 0;
}
static FILE out = FDEV_SETUP_STREAM(put, NULL, _FDEV_SETUP_WRITE);

static const uint16_t squares[] PROGMEM = {0, 1, 4, 9, 16, 25, 36, 49, 64, 81};
volatile int64_t dividend = 1234567890123456789LL;
volatile int64_t divisors[] = {7, -1000003, 65537, 4294967311LL};
volatile uint32_t seed = 12345;

static uint32_t next(void) {
    seed = seed * 1664525UL + 1013904223UL;
    return seed >> 8;
}
static int compare(const void *a, const void *b) {
    const int16_t x = *(const int16_t *)a, y = *(const int16_t *)b;
    return x < y ? -1 : x > y;
}
static uint16_t crc(const uint8_t *data, uint16_t length) {
    uint16_t value = 0xFFFF;
    while (length--) {
        value ^= (uint16_t)*data++ << 8;
        for (uint8_t i = 0; i < 8; i++)
            value = value & 0x8000 ? value << 1 ^ 0x1021 : value << 1;
    }
    return value;
}
static uint32_t ackermann(uint32_t m, uint32_t n) {
    return m == 0 ? n + 1 : n == 0 ? ackermann(m - 1, 1) : ackermann(m - 1, ackermann(m, n - 1));
}
static int by_case(uint8_t n) {
    switch (n) {
    case 0: return 11;
    case 1: return -7;
    case 2: return 30000;
    case 3: return 4;
    case 4: return 55;
    case 5: return -32768;
    case 9: return 1;
    default: return n;
    }
}
static int (*volatile function)(uint8_t) = by_case;

static void print64(int64_t value) {
    char text[24];
    uint8_t at = sizeof text;
    uint64_t rest = value < 0 ? -(uint64_t)value : (uint64_t)value;
    text[--at] = 0;
    do
        text[--at] = '0' + rest % 10;
    while (rest /= 10);
    printf("%s%s\n", value < 0 ? "-" : "", text + at);
}

void finished(void) __attribute__((noinline, noclone));
void finished(void) {
    for (;;)
        asm volatile("");
}

int main(void) {
    stdout = &out;
    for (uint8_t i = 0; i < 4; i++) {
        print64(dividend / divisors[i]);
        print64(dividend % divisors[i]);
        print64(dividend * divisors[i]);
        print64(dividend >> (5 * i + 1));
    }
    for (int8_t i = -5; i < 8; i++) {
        volatile float x = 0.37f * i + 0.01f;
        printf("%d %f %e %g %f %f\n", i, x, exp(x), sqrt(fabs(x)), sin(x), atan2(x, 0.5f));
    }
    int16_t values[60];
    for (uint8_t i = 0; i < 60; i++)
        values[i] = (int16_t)next();
    qsort(values, 60, sizeof *values, compare);
    for (uint8_t i = 0; i < 60; i += 7)
        printf("%d,%u,%x ", values[i], (unsigned)values[i] / 7, values[i] % 13);
    printf("\n%04x %ld\n", crc((const uint8_t *)values, sizeof values), (long)ackermann(2, 6));
    for (uint8_t i = 0; i < 12; i++)
        printf("%d %u; ", function(i), i < 10 ? pgm_read_word(&squares[i]) : 0);
    char text[64];
    strcpy_P(text, PSTR("in flash"));
    strcat(text, " and RAM");
    printf("%s %u %ld %lu\n", text, strlen(text), strtol("-123456", NULL, 10), 4000000000UL / 77);
    finished();
}
