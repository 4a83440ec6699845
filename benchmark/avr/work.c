/* What `puckloop bench --case avr` executes on this project's core and on libsimavr: one endless piece of work per
   program, chosen by CRC, SORT or MATRIX. Needs no C library. */
#include <stdint.h>

__attribute__((naked, used, section(".vectors"))) void start(void) {
    __asm__ volatile("clr r1\n out 0x3F, r1\n ldi r28, 0xFF\n ldi r29, 0x40\n out 0x3E, r29\n out 0x3D, r28\n rjmp main");
}

volatile uint16_t result; /* keeps the compiler from leaving work out */

#ifdef CRC
/* CRC-16/CCITT, bit by bit. */
int main(void) {
    static uint8_t bytes[256];
    for (uint16_t i = 0; i < sizeof bytes; ++i) bytes[i] = (uint8_t)(i * 7);
    for (;;) {
        uint16_t crc = 0xFFFF;
        for (uint16_t i = 0; i < sizeof bytes; ++i) {
            crc ^= (uint16_t)(bytes[i] << 8);
            for (uint8_t bit = 0; bit < 8; ++bit) crc = crc & 0x8000 ? (uint16_t)(crc << 1 ^ 0x1021) : (uint16_t)(crc << 1);
        }
        result = crc;
        bytes[0] = (uint8_t)crc;
    }
}
#endif

#ifdef SORT
/* Quicksort of 16-bit numbers, recursive, by a comparison through a pointer. */
static int before(const int16_t* a, const int16_t* b) {
    return *a < *b;
}
int (*volatile comparison)(const int16_t*, const int16_t*);

static void sort(int16_t* first, int16_t* last) {
    while (first < last) {
        int16_t pivot = first[(last - first) / 2];
        int16_t *low = first, *high = last;
        for (;;) {
            while (comparison(low, &pivot)) ++low;
            while (comparison(&pivot, high)) --high;
            if (low >= high) break;
            int16_t kept = *low;
            *low++ = *high;
            *high-- = kept;
        }
        sort(first, high < low ? high : high - 1);
        first = high + 1;
    }
}

int main(void) {
    static int16_t numbers[200];
    uint16_t seed = 1;
    comparison = before;
    for (;;) {
        for (uint8_t i = 0; i < 200; ++i) {
            seed = seed * 25173u + 13849u;
            numbers[i] = (int16_t)seed;
        }
        sort(numbers, numbers + 199);
        result = (uint16_t)numbers[100];
    }
}
#endif

#ifdef MATRIX
/* Product of two 16 x 16 matrices of 16-bit numbers. */
int main(void) {
    static int16_t a[16][16], b[16][16], c[16][16];
    for (uint8_t i = 0; i < 16; ++i)
        for (uint8_t j = 0; j < 16; ++j) {
            a[i][j] = (int16_t)(i * 3 + j);
            b[i][j] = (int16_t)(i - j * 5);
        }
    for (;;) {
        for (uint8_t i = 0; i < 16; ++i)
            for (uint8_t j = 0; j < 16; ++j) {
                int16_t sum = 0;
                for (uint8_t k = 0; k < 16; ++k) sum = (int16_t)(sum + a[i][k] * b[k][j]);
                c[i][j] = sum;
            }
        a[3][4] = c[1][2];
        result = (uint16_t)c[5][5];
    }
}
#endif
