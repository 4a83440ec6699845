#include "frames.h"

#include "registers.h"

#define SLOTS 11 /* ten wait, one is on the air */
#define DEFAULT_BITS 16

static struct frame slots[SLOTS];
static volatile u8 count;        /* requested, the one on the air included */
static volatile u8 built;        /* of these, from the oldest on, with chips */
static volatile u8 oldest;       /* slot */
static volatile u8 on_air;       /* 1: the oldest is being sent */
static volatile u8 generation;   /* changes when what waits is forgotten */
static volatile u8 size_setting; /* 0: DEFAULT_BITS */

/* Port B's bit of each emitter. */
static const u16 emitter_bit[SENSORS] = {1U << 3,  1U << 4,  1U << 5,  1U << 8,  1U << 9,  1U << 10,
                                         1U << 11, 1U << 12, 1U << 13, 1U << 14, 1U << 15, 1U << 0};

static u8 slot_after(u8 first, u8 steps) {
    u8 slot = first + steps;
    if (slot >= SLOTS) slot -= SLOTS;
    return slot;
}

u8 frames_bits(void) {
    return size_setting == 0 ? DEFAULT_BITS : size_setting;
}

void frames_set_bits(u8 bits) {
    if (bits != 8 && bits != 16 && bits != 24 && bits != 32) return;
    DISI(100);
    size_setting = bits;
    ++generation;
    count = on_air;
    built = on_air;
    DISI(0);
}

/* The slot that many places after the oldest; the emitter must not move on in between. */
static struct frame* slot_at(const volatile u8* place) {
    u8 slot;
    DISI(100);
    slot = slot_after(oldest, *place);
    DISI(0);
    return &slots[slot];
}

/* A new request's slot, null when all are taken. */
static struct frame* request(void) {
    struct frame* frame;
    if (count >= SLOTS) return 0;
    frame = slot_at(&count);
    frame->bits = frames_bits();
    return frame;
}

static void submit(void) {
    DISI(100);
    ++count;
    DISI(0);
}

void frames_send_all(u32 payload) {
    struct frame* frame = request();
    if (frame == 0) return;
    frame->armed = EMITTERS;
    frame->same = 1;
    frame->payload[0] = payload;
    submit();
}

void frames_send_each(u16 emitters, const u32* payload) {
    struct frame* frame = request();
    u16 armed = 0;
    u8 i;
    if (frame == 0) return;
    for (i = 0; i < SENSORS; ++i) {
        if (!(emitters & (1 << i))) continue;
        armed |= emitter_bit[i];
        frame->payload[i] = payload[i];
    }
    frame->armed = armed;
    frame->same = 0;
    submit();
}

/* The payload's low bits, least significant first, then the check, most significant first: the check makes
 * the number of ones a multiple of 16. Marks the emitters `gates` in every bit that is 1. */
static void spread(struct frame* frame, u32 payload, u16 gates) {
    u16* ones = frame->ones;
    u8 set = 0;
    u8 left;
    for (left = frame->bits; left != 0; --left) {
        if (payload & 1) {
            *ones |= gates;
            ++set;
        }
        payload >>= 1;
        ++ones;
    }
    set = -set;
    for (left = CHECK_BITS; left != 0; --left) {
        if (set & (1 << (CHECK_BITS - 1))) *ones |= gates;
        set <<= 1;
        ++ones;
    }
}

/* 1: a request without chips is there. The emitter lowers both counts together. */
static u8 behind(void) {
    u8 is_behind;
    DISI(100);
    is_behind = built != count;
    DISI(0);
    return is_behind;
}

void frames_build(void) {
    const u8 begun = generation;
    struct frame* frame;
    u8 i;
    if (!behind()) return;
    frame = slot_at(&built);
    for (i = 0; i < MAX_BITS + CHECK_BITS; ++i)
        frame->ones[i] = 0;
    if (frame->same) {
        spread(frame, frame->payload[0], EMITTERS);
    } else {
        for (i = 0; i < SENSORS; ++i)
            if (frame->armed & emitter_bit[i]) spread(frame, frame->payload[i], emitter_bit[i]);
    }
    DISI(100);
    if (begun == generation) ++built;
    DISI(0);
}

const struct frame* frames_next(void) {
    return built == 0 ? 0 : &slots[oldest];
}

void frames_begin(void) {
    on_air = 1;
}

void frames_done(void) {
    on_air = 0;
    oldest = slot_after(oldest, 1);
    --count;
    --built;
}
