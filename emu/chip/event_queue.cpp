#include "emu/chip/event_queue.h"

#include <stdexcept>

namespace puckloop::chip {

EventQueue::Slot EventQueue::add(void* owner, Handler handler) {
    if (size_ == kCapacity) throw std::logic_error("event queue: more slots than planned for");
    handlers_[size_] = {handler, owner};
    return static_cast<Slot>(size_++);
}

}  // namespace puckloop::chip
