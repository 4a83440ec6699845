#pragma once
// What changes of a memory while a mark is set: nothing of it is copied at a mark, each change is noted and
// taken back in reverse order.

#include <cstdint>
#include <vector>

namespace puckloop::avr {

template <class Value>
class MemoryUndo {
  public:
    /// Notes from here on; forgets earlier notes.
    void begin() {
        notes_.clear();
        on_ = true;
    }
    void end() {
        notes_.clear();
        on_ = false;
    }
    /// Before a cell changes.
    void note(std::uint32_t address, Value before) {
        if (on_) notes_.push_back({address, before});
    }
    /// Calls `store(address, value)` for everything noted, the latest first; notes go on.
    template <class Store>
    void rewind(Store store) {
        on_ = false;  // what follows is no change to note
        for (auto note = notes_.rbegin(); note != notes_.rend(); ++note)
            store(note->address, note->value);
        begin();
    }

  private:
    struct Note {
        std::uint32_t address = 0;
        Value value{};
    };
    bool on_ = false;
    std::vector<Note> notes_;
};

}  // namespace puckloop::avr
