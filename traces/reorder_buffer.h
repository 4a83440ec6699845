#pragma once
// Puts items that come a bounded time late into the order of their times, without keeping all of them.

#include "cosim/core/time.h"

#include <cstdint>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace puckloop::tools {

/// Items of one time keep the order in which they came.
template <class Item>
class ReorderBuffer {
  public:
    void push(cosim::Time time, Item item) { queue_.push({time, count_++, std::move(item)}); }
    bool empty() const { return queue_.empty(); }
    /// Of the first item; only while not empty().
    cosim::Time first() const { return queue_.top().time; }
    Item pop() {
        Item item = queue_.top().item;
        queue_.pop();
        return item;
    }

  private:
    struct Entry {
        cosim::Time time;
        std::uint64_t order;
        Item item;
        bool operator<(const Entry& other) const {
            return std::tie(other.time, other.order) < std::tie(time, order);
        }
    };
    std::priority_queue<Entry> queue_;
    std::uint64_t count_ = 0;
};

}  // namespace puckloop::tools
