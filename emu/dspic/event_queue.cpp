#include "emu/dspic/event_queue.h"

#include <stdexcept>

namespace puckloop::dspic {

EventQueue::Slot EventQueue::add(void* owner, Handler handler) {
    if (size_ == kCapacity) throw std::logic_error("event queue: more slots than planned for");
    entries_[static_cast<std::size_t>(size_)] = {kNoCycle, handler, owner};
    return static_cast<Slot>(size_++);
}

void EventQueue::schedule(Slot slot, Cycle due) {
    const Cycle before = entries_[slot].due;
    entries_[slot].due = due;
    if (due < next_)
        next_ = due;
    else if (before == next_)
        find_next();
}

void EventQueue::find_next() {
    next_ = kNoCycle;
    for (int i = 0; i < size_; ++i)
        if (entries_[static_cast<std::size_t>(i)].due < next_)
            next_ = entries_[static_cast<std::size_t>(i)].due;
}

void EventQueue::service(Cycle now) {
    while (next_ <= now) {
        const Cycle due = next_;
        for (int i = 0; i < size_; ++i) {
            Entry& entry = entries_[static_cast<std::size_t>(i)];
            if (entry.due != due) continue;
            entry.due = kNoCycle;
            find_next();
            entry.handler(entry.owner, due);
            break;
        }
    }
}

}  // namespace puckloop::dspic
