/* A frame, as one sensor sees it: on for 6 chips, or 7 when the first bit is a 1; then runs of one or two
 * chips, on and off in turn. A run is measured from edge to edge, so that neither the sender's clock nor the
 * phase matters; an edge may be off by 0.4 chips. */
#include "receiver.h"

#include "peaks.h"
#include "registers.h"
#include "sampler.h"

/* Runs, in ticks: 10 a chip */
#define SHORTEST 5          /* shorter ones are no chips */
#define TWO_CHIPS 15        /* from here on two */
#define TOO_LONG 25         /* from here on no data */
#define PREAMBLE 55         /* from here on a preamble of 6 chips */
#define PREAMBLE_AND_ONE 65 /* 7: the first bit is a 1 */
#define NO_PREAMBLE 76
#define RESET_FROM 30 /* of the preamble: the peak detector is discharged */
#define RESET_TO 45
#define GATHERING 45     /* after a frame's last falling edge all its sensors have told, */
#define NEWBORN 12       /* and so long after the first of them told */
#define TOGETHER 8       /* last falling edges of one frame at different sensors */
#define FORGOTTEN 200    /* a run of this length will never matter */
#define DARK_RESET 12    /* the detectors are discharged */
#define DARK_SETTLED 220 /* and have seen 2 ms of whatever there is */
#define DARK_ANYWAY 5000 /* if the air is not free of light for so long, 50 ms, this is darkness */

#define HALF_NONE 2
#define GROUPS 4
#define RECEPTIONS 6
#define DEFAULT_BITS 16

enum state {
    WAITING, /* for a preamble */
    DATA,
    HELD,  /* a good frame, and dark since: the frame must end here */
    BEYOND /* light again soon after: the next preamble, or a longer frame that only looked good */
};

struct sensor {
    u16 since; /* tick of the last edge */
    u16 fell;  /* tick of the last falling edge */
    u32 payload;
    u8 state;
    u8 half; /* first chip of the bit, HALF_NONE: none */
    u8 left; /* bits */
    u8 ones; /* in the payload */
    u8 check;
};

struct group {
    u16 sensors; /* none: not in use */
    u16 fell;
    u16 born;
    u32 payload;
};

static struct sensor sensor[SENSORS];
static struct group group[GROUPS];
static struct reception receptions[RECEPTIONS];
static volatile u8 receptions_in;
static volatile u8 receptions_out;
static volatile u8 new_bits; /* to be set */
static u8 bits;
static u16 lit;      /* as the receivers know it */
static u16 active;   /* not WAITING */
static u16 long_run; /* level unchanged for FORGOTTEN ticks */
static volatile u16 dazzled;
static volatile u8 dark_wanted;
static u8 dark_step;
static u16 dark_since;
static u16 dark_begun;

static void wait(struct sensor* s, u16 bit) {
    s->state = WAITING;
    active &= ~bit;
}

static void begin(struct sensor* s, u16 bit, u8 half) {
    s->state = DATA;
    s->payload = 0;
    s->half = half;
    s->left = bits + CHECK_BITS;
    s->ones = 0;
    s->check = 0;
    active |= bit;
}

/* Sensor `s` has a good frame for sure: it joins those that got the same frame with it. */
static void deliver(struct sensor* s, u16 bit, u16 now) {
    struct group* free = 0;
    u8 i;
    wait(s, bit);
    for (i = 0; i < GROUPS; ++i) {
        struct group* g = &group[i];
        if (g->sensors == 0) {
            free = g;
        } else if (g->payload == s->payload && (u16)(s->fell - g->fell + TOGETHER) <= 2 * TOGETHER) {
            g->sensors |= bit;
            return;
        }
    }
    if (free == 0) return;
    free->sensors = bit;
    free->payload = s->payload;
    free->fell = s->fell;
    free->born = now;
}

/* All bits are there. */
static void complete(struct sensor* s, u16 bit) {
    u8 i;
    if ((s->ones + s->check) & ((1 << CHECK_BITS) - 1)) {
        wait(s, bit);
        return;
    }
    for (i = bits; i < MAX_BITS; i += 8)
        s->payload >>= 8;
    s->state = HELD;
    peaks_read(bit);
}

/* One chip of a frame. */
static void take_chip(struct sensor* s, u16 bit, u8 on) {
    if (s->state == HELD) {
        if (on) wait(s, bit); /* longer than a frame may be */
        return;
    }
    if (s->state != DATA) return;
    if (s->half == HALF_NONE) {
        s->half = on;
        return;
    }
    if (s->half == on) { /* no bit has two equal chips */
        wait(s, bit);
        return;
    }
    if (s->left > CHECK_BITS) {
        s->payload >>= 1;
        if (s->half) {
            s->payload |= 0x80000000UL;
            ++s->ones;
        }
    } else {
        s->check = s->check << 1 | s->half;
    }
    s->half = HALF_NONE;
    if (--s->left == 0) complete(s, bit);
}

static void take_run(struct sensor* s, u16 bit, u8 on, u16 run) {
    if (run < SHORTEST) {
        wait(s, bit);
        return;
    }
    take_chip(s, bit, on);
    if (run >= TWO_CHIPS) take_chip(s, bit, on);
}

static void rising_edge(struct sensor* s, u16 bit, u16 run) {
    if (s->state == WAITING) return;
    if (run >= TOO_LONG) { /* what was due by then has been done */
        wait(s, bit);
        return;
    }
    take_run(s, bit, 0, run);
    if (s->state == HELD) s->state = BEYOND;
}

static void falling_edge(struct sensor* s, u16 bit, u16 run, u16 now) {
    if (run >= PREAMBLE && run < NO_PREAMBLE) {
        if (s->state == BEYOND) deliver(s, bit, now);
        begin(s, bit, run >= PREAMBLE_AND_ONE ? 1 : HALF_NONE);
    } else if (run >= TOO_LONG || s->state == BEYOND) {
        wait(s, bit);
    } else if (s->state != WAITING) {
        take_run(s, bit, 1, run);
    }
    s->fell = now;
}

static void take_change(const struct change* change) {
    u16 left = lit ^ change->lit;
    u16 bit = 1;
    struct sensor* s = sensor;
    lit = change->lit;
    while (left != 0) {
        if (left & bit) {
            const u16 run = long_run & bit ? FORGOTTEN : change->tick - s->since;
            left &= ~bit;
            long_run &= ~bit;
            s->since = change->tick;
            if (lit & bit) {
                rising_edge(s, bit, run);
            } else {
                falling_edge(s, bit, run, change->tick);
            }
        }
        bit <<= 1;
        ++s;
    }
}

/* What becomes due without an edge. Gives the detectors to discharge. */
static u16 take_time(u16 now) {
    u16 discharge = 0;
    u16 left = active | (ALL_SENSORS & ~long_run);
    u16 bit = 1;
    struct sensor* s = sensor;
    while (left != 0) {
        if (left & bit) {
            const u16 run = now - s->since;
            left &= ~bit;
            if (lit & bit) {
                if (run >= RESET_FROM && run < RESET_TO) discharge |= bit;
                if (run >= NO_PREAMBLE) wait(s, bit);
            } else if (active & bit) {
                if (run >= TWO_CHIPS && s->state == DATA && s->left == 1 && s->half == 1)
                    take_chip(s, bit, 0);
                if (run >= TOO_LONG && s->state == HELD) deliver(s, bit, now);
                if (run >= TOO_LONG) wait(s, bit);
            }
            if (run >= FORGOTTEN) long_run |= bit;
        }
        bit <<= 1;
        ++s;
    }
    return discharge;
}

/* Groups whose sensors have all told become receptions; when nobody takes these, the newest is lost. */
static void close_groups(u16 now) {
    u8 i;
    for (i = 0; i < GROUPS; ++i) {
        struct group* g = &group[i];
        const u8 next = receptions_in + 1 == RECEPTIONS ? 0 : receptions_in + 1;
        struct reception* r = &receptions[receptions_in];
        u16 bit = 1;
        u8 k;
        if (g->sensors == 0 || now - g->fell < GATHERING || now - g->born < NEWBORN) continue;
        if (peaks_awaited() & g->sensors) continue;
        r->payload = g->payload;
        for (k = 0; k < SENSORS; ++k) {
            r->peak[k] = g->sensors & bit ? peak_above_dark(k) : 0;
            bit <<= 1;
        }
        g->sensors = 0;
        if (next != receptions_out) receptions_in = next;
    }
}

/* Darkness: the detectors discharged, 2 ms without light, then a reading. Gives the detectors to discharge.
 */
static u16 measure_dark(u16 now) {
    const u8 air_is_free = ((lit & ~dazzled) == 0 && active == 0) || (u16)(now - dark_begun) >= DARK_ANYWAY;
    const u16 passed = now - dark_since;
    if (dark_step == 0) {
        dark_begun = now;
        dark_step = 1;
    }
    if (dark_step == 1 || !air_is_free) { /* begin, once there is no light */
        dark_step = 1;
        if (!air_is_free) return 0;
        dark_since = now;
        dark_step = 2;
    } else if (dark_step == 2 && passed >= DARK_RESET) {
        dark_since = now;
        dark_step = 3;
    } else if (dark_step == 3 && passed >= DARK_SETTLED) {
        peaks_read(ALL_SENSORS);
        dark_step = 4;
    } else if (dark_step == 4 && peaks_awaited() == 0) {
        peaks_set_dark();
        dark_step = 0;
        dark_wanted = 0;
    }
    return dark_step == 2 ? ALL_SENSORS : 0;
}

static void forget(void) {
    u16 bit = 1;
    u8 i;
    for (i = 0; i < SENSORS; ++i) {
        wait(&sensor[i], bit);
        bit <<= 1;
    }
}

void INTERRUPT _INT1Interrupt(void) {
    struct change change;
    u16 discharge;
    u16 now;
    IFS1 &= ~INT1IF;
    if (new_bits != 0) {
        bits = new_bits;
        new_bits = 0;
        forget();
    }
    while (sampler_take(&change))
        take_change(&change);
    now = sampler_tick(); /* not before any change that was taken */
    if (sampler_overrun()) forget();
    discharge = take_time(now);
    dazzled = lit & long_run;
    if (dark_wanted) discharge |= measure_dark(now);
    peaks_reset(discharge);
    close_groups(now);
}

void receiver_start(void) {
    bits = DEFAULT_BITS;
    long_run = ALL_SENSORS;
    IPC5 = (IPC5 & ~IP_MASK(INT1IP)) | INT1IP(LEVEL_RECEIVER);
    IEC1 |= INT1IF;
}

void receiver_set_bits(u8 wanted) {
    new_bits = wanted;
}

u8 receiver_take(struct reception* reception) {
    u8 out = receptions_out;
    if (out == receptions_in) return 0;
    *reception = receptions[out];
    receptions_out = out + 1 == RECEPTIONS ? 0 : out + 1;
    return 1;
}

u16 receiver_dazzled(void) {
    return dazzled;
}

void receiver_measure_dark(void) {
    dark_step = 0;
    dark_wanted = 1;
}

u8 receiver_measuring_dark(void) {
    return dark_wanted;
}
