#pragma once
// Interrupts that a fault keeps back: each is handed on when its time has come.

#include "emu/chip/event_queue.h"

#include <algorithm>
#include <vector>

namespace puckloop::chip {

class HeldInterrupts {
  public:
    /// `lost`: it is only to be forgotten.
    using Deliver = void (*)(void* owner, int vector, bool lost, Cycle due);

    HeldInterrupts(EventQueue& events, void* owner, Deliver deliver)
        : events_(events), owner_(owner), deliver_(deliver), slot_(events.add(this, &come)) {}
    HeldInterrupts(const HeldInterrupts&) = delete;
    HeldInterrupts& operator=(const HeldInterrupts&) = delete;

    void hold(int vector, bool lost, Cycle until) {
        const Held one{until, vector, lost};
        const auto later = [](const Held& a, const Held& b) { return a.due < b.due; };
        held_.insert(std::upper_bound(held_.begin(), held_.end(), one, later), one);
        events_.schedule(slot_, held_.front().due);
    }
    /// A reset: none of them comes.
    void reset() {
        if (held_.empty()) return;
        held_.clear();
        events_.cancel(slot_);
    }

    template <class Archive>
    void state(Archive& archive) {
        archive(held_);
    }

  private:
    struct Held {
        Cycle due = 0;
        int vector = 0;
        bool lost = false;

        template <class Archive>
        void state(Archive& archive) {
            archive(due);
            archive.bounded(vector, 0, 127);
            archive(lost);
        }
    };
    static void come(void* owner, Cycle due) {
        auto& self = *static_cast<HeldInterrupts*>(owner);
        while (!self.held_.empty() && self.held_.front().due <= due) {
            const Held one = self.held_.front();
            self.held_.erase(self.held_.begin());
            self.deliver_(self.owner_, one.vector, one.lost, due);
        }
        if (!self.held_.empty()) self.events_.schedule(self.slot_, self.held_.front().due);
    }

    EventQueue& events_;
    void* owner_;
    Deliver deliver_;
    EventQueue::Slot slot_;
    std::vector<Held> held_;  // by due
};

}  // namespace puckloop::chip
