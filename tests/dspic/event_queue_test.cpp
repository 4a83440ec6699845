// The timetable against a plain list: order of events, slots that handlers schedule again, cancelled ones.

#include "base/random.h"
#include "emu/chip/event_queue.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

using namespace puckloop;
using chip::Cycle;
using chip::EventQueue;
using chip::kNoCycle;

namespace {

struct Happened {
    unsigned slot = 0;
    Cycle due = 0;
    bool operator==(const Happened&) const = default;
};

/// Slots whose handlers schedule themselves and others, by a random stream that both sides have.
struct Plan {
    RandomStream random;
    unsigned slots;
    std::vector<Happened> happened;

    template <class Schedule>
    void handle(unsigned slot, Cycle due, Schedule schedule) {
        happened.push_back({slot, due});
        const auto later = [&] { return due + random.below(50) * random.below(3); };
        if (random.below(4) != 0) schedule(slot, later() + 1);
        while (random.below(3) == 0) {
            const auto other = static_cast<unsigned>(random.below(slots));
            schedule(other, random.below(5) == 0 ? kNoCycle : later() + (other == slot ? 1 : 0));
        }
    }
};

struct Slot {
    struct Queue* queue = nullptr;
    unsigned number = 0;
};
struct Queue {
    Plan plan;
    EventQueue events;
    std::vector<Slot> slots;

    Queue(RandomStream random, unsigned count) : plan{std::move(random), count, {}}, slots(count) {
        for (unsigned i = 0; i < count; ++i) {
            slots[i] = {this, i};
            events.add(&slots[i], [](void* owner, Cycle due) {
                Slot& slot = *static_cast<Slot*>(owner);
                EventQueue& queue = slot.queue->events;
                CHECK(queue.due(static_cast<EventQueue::Slot>(slot.number)) == kNoCycle);
                slot.queue->plan.handle(slot.number, due, [&](unsigned other, Cycle at) {
                    queue.schedule(static_cast<EventQueue::Slot>(other), at);
                });
            });
        }
    }
};

struct List {
    Plan plan;
    std::vector<Cycle> due;

    List(RandomStream random, unsigned count) : plan{std::move(random), count, {}}, due(count, kNoCycle) {}
    void service(Cycle now) {
        for (;;) {
            const auto first = std::min_element(due.begin(), due.end());
            if (*first > now) return;
            const Cycle at = std::exchange(*first, kNoCycle);
            plan.handle(static_cast<unsigned>(first - due.begin()), at,
                        [&](unsigned other, Cycle when) { due[other] = when; });
        }
    }
};

}  // namespace

TEST_CASE("events come by cycle, then by slot, whatever their handlers schedule") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        RandomStream random(seed, "event queue");
        const auto slots = static_cast<unsigned>(1 + random.below(64));
        const RandomStream both(seed, "handlers");
        Queue queue(both, slots);
        List list(both, slots);
        Cycle now = 0;
        for (int i = 0; i < 300; ++i) {
            const auto slot = static_cast<unsigned>(random.below(slots));
            const Cycle due = random.below(4) == 0 ? kNoCycle : now + random.below(200);
            queue.events.schedule(static_cast<EventQueue::Slot>(slot), due);
            list.due[slot] = due;
            const auto first = std::min_element(list.due.begin(), list.due.end());
            REQUIRE(queue.events.next() == *first);
            if (*first != kNoCycle) REQUIRE(queue.events.next_slot() == first - list.due.begin());
            std::vector<Cycle> others = list.due;
            others[slot] = kNoCycle;
            REQUIRE(queue.events.next_except(static_cast<EventQueue::Slot>(slot)) ==
                    *std::min_element(others.begin(), others.end()));
            now += random.below(60);
            queue.events.service(now);
            list.service(now);
            REQUIRE(queue.plan.happened == list.plan.happened);
        }
    }
}
