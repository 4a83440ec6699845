#include "messages.h"

#define SLOTS 11 /* one stays free, to tell full from empty */

static struct message slots[SLOTS];
static volatile u8 in;
static volatile u8 out;

static u8 after(u8 slot) {
    return slot + 1 == SLOTS ? 0 : slot + 1;
}

void messages_put(const struct message* message) {
    const u8 next = after(in);
    if (next == out) return;
    slots[in] = *message;
    in = next;
}

u8 messages_take(struct message* message) {
    if (in == out) return 0;
    *message = slots[out];
    out = after(out);
    return 1;
}
