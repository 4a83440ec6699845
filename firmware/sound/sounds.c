#include "sounds.h"

#define BLOCK 64 /* samples between changes of pitch and loudness */
#define SOFT 64  /* loudness at both ends of a call, of */
#define LOUD 256 /* in its middle */

/* A phase of 65536 is a whole period: an increment of 65536 f / 7200. */
#define PITCH(hertz) ((u16)(65536UL * (hertz) / 7200))

static volatile u16 left; /* samples still to be played */
static volatile u16 length;
static u16 phase;
static u16 pitch;
static s16 slide; /* of the pitch, each block */
static u16 loudness;
static u8 gain;
static u8 block;
static u8 blocks;

/* A sine's parabola: -8192..8192 over a period. */
static s16 wave(u16 at) {
    const s16 half = (s16)(at << 1) >> 2; /* -8192..8191 within each half period */
    const s16 bow = 8192 - (s16)(__builtin_mulss(half, half) >> 13);
    return at & 0x8000 ? -bow : bow;
}

static void next_block(void) {
    const u8 from_an_end = block + block < blocks ? block : blocks - block;
    loudness = SOFT + (LOUD - SOFT) * 2 * from_an_end / blocks;
    if (block != 0) pitch += slide;
    ++block;
}

s16 sounds_sample(void) {
    s16 voice;
    if (left == 0) return 0;
    if (((length - left) & (BLOCK - 1)) == 0) next_block();
    voice = wave(phase) + (wave(phase << 1) >> 1) + (wave(phase + (phase << 1)) >> 1);
    phase += pitch;
    --left;
    voice = (s16)(__builtin_mulss(voice, (s16)loudness) >> 10);
    return (s16)(__builtin_mulss(voice, gain) >> 3);
}

/* Gains are such that a robot 10 cm away reads what it reads of BTcom's calls, as medians. */
static void begin(u16 samples, u16 from, u16 to, u8 eighths) {
    left = 0; /* the interrupt keeps away from what follows */
    length = samples;
    phase = 0;
    gain = eighths;
    pitch = from;
    block = 0;
    blocks = (u8)(samples / BLOCK + 1);
    slide = (s16)(to - from) / (s16)blocks;
    left = samples;
}

void sounds_play(u8 number) {
    switch (number) {
    case 1: begin(2112, PITCH(310), PITCH(240), 18); break;
    case 2: begin(1760, PITCH(520), PITCH(330), 12); break;
    case 3: begin(3412, PITCH(280), PITCH(410), 14); break;
    case 4: begin(3732, PITCH(610), PITCH(260), 11); break;
    case 5: begin(8016, PITCH(260), PITCH(480), 20); break;
    default: left = 0;
    }
}

u8 sounds_playing(void) {
    return left != 0;
}
