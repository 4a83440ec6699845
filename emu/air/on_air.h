#pragma once
// The frames on one medium: which of them are at the same time.

#include "cosim/core/time.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace puckloop::air {

/// Transmission: `id`, `start`, `end`.
template <class Transmission>
bool overlaps(const Transmission& one, cosim::Time start, cosim::Time end) {
    return one.start < end && start < one.end;
}

template <class Transmission>
class OnAir {
  public:
    const Transmission& add(Transmission one) {
        all_.push_back(std::move(one));
        return all_.back();
    }
    /// Calls `look` with each other one at the same time, in the order in which they were added, until it
    /// gives false.
    template <class Look>
    void look_beside(const Transmission& one, Look look) const {
        for (const Transmission& other : all_)
            if (other.id != one.id && overlaps(other, one.start, one.end) && !look(other)) return;
    }
    /// Those for which `is_old` holds.
    template <class IsOld>
    void forget(IsOld is_old) {
        std::erase_if(all_, is_old);
    }

    auto begin() const { return all_.begin(); }
    auto end() const { return all_.end(); }
    std::size_t size() const { return all_.size(); }
    Transmission& operator[](std::size_t i) { return all_[i]; }
    const Transmission& operator[](std::size_t i) const { return all_[i]; }

  private:
    std::vector<Transmission> all_;
};

}  // namespace puckloop::air
