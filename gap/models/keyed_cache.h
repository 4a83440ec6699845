#pragma once
// What takes long to work out, kept by the numbers it depends on, for several threads at a time.

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace puckloop::gap {

/// Keeps the last few values. A fit on each of a few threads moves one number at a time and comes back.
template <class Value>
class KeyedCache {
  public:
    /// The value of this key; made by `make()` where it is not kept.
    template <class Make>
    std::shared_ptr<const Value> get(const std::vector<double>& key, Make make) const {
        {
            const std::lock_guard lock(mutex_);
            for (auto one = kept_.begin(); one != kept_.end(); ++one)
                if (one->first == key) {
                    kept_.splice(kept_.begin(), kept_, one);
                    return kept_.front().second;
                }
        }
        auto value = std::make_shared<const Value>(make());
        const std::lock_guard lock(mutex_);
        kept_.emplace_front(key, value);
        if (kept_.size() > kMost) kept_.pop_back();
        return value;
    }

  private:
    static constexpr std::size_t kMost = 16;
    mutable std::mutex mutex_;
    mutable std::list<std::pair<std::vector<double>, std::shared_ptr<const Value>>> kept_;
};

}  // namespace puckloop::gap
