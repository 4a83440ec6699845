#include "bearing.h"

#include "fixed.h"

#define STRONGEST 0x10000000UL /* of squares handed to length() */

struct look {
    s32 angle;  /* of the sensor, as fixed.h has it */
    s32 cosine; /* * 65536 */
    s32 sine;
};

/* 15, 50, 75, 105, 133, 159, -165, -135, -105, -77, -50, -15 degrees */
static const struct look look[SENSORS] = {
    {85786423, 63303, 16962},     {285954745, 42126, 50203},    {428932117, 16962, 63303},
    {600504964, -16962, 63303},   {760639621, -44695, 47930},   {909336088, -61183, 23486},
    {-943650657, -63303, -16962}, {-772077811, -46341, -46341}, {-600504964, -16962, -63303},
    {-440370307, 14742, -63856},  {-285954745, 42126, -50203},  {-85786423, 63303, -16962},
};

/* What the sensor would have read with the light straight ahead of it, squared: its response to light from
 * aside is the root of the cosine. */
static u32 squared_ahead(u16 peak, s32 aside) {
    const u32 c = cosine(aside);
    return c == 0 ? 0xFFFFFFFFUL : divide((u32)peak * peak, c, COSINE_BITS);
}

static u16 strength(u32 first, u32 second) {
    u8 halvings = 0;
    u32 root;
    while (first >= STRONGEST || second >= STRONGEST) {
        first >>= 2;
        second >>= 2;
        ++halvings;
    }
    root = square_root(length(first, second));
    root <<= halvings;
    return root > 0xFFFF ? 0xFFFF : root;
}

void find_place(const u16* peaks, struct place* place) {
    s32 ahead = 0;
    s32 left = 0;
    s32 angle;
    u8 first = NO_SENSOR;
    u8 second = NO_SENSOR;
    u8 i;
    for (i = 0; i < SENSORS; ++i) {
        const u16 peak = peaks[i];
        if (peak == 0) continue;
        ahead += (s32)peak * look[i].cosine;
        left += (s32)peak * look[i].sine;
        if (first == NO_SENSOR || peak > peaks[first]) {
            second = first;
            first = i;
        } else if (second == NO_SENSOR || peak > peaks[second]) {
            second = i;
        }
    }
    place->sensor = first;
    place->bearing = 0;
    place->range = 0;
    place->peak = 0;
    if (first == NO_SENSOR) return;
    place->peak = peaks[first];
    angle = direction(ahead, left);
    place->bearing = angle >= 0 ? (s16)(angle >> ANGLE_BITS) : -(s16)(-angle >> ANGLE_BITS);
    place->range =
        strength(squared_ahead(peaks[first], angle - look[first].angle),
                 second == NO_SENSOR ? 0 : squared_ahead(peaks[second], angle - look[second].angle));
}
