#include "cosim/core/octets.h"

#include <mutex>
#include <set>

namespace puckloop::cosim {

Octets::Octets(std::span<const std::uint8_t> octets) {
    if (octets.empty()) return;
    static std::mutex mutex;
    static std::set<std::vector<std::uint8_t>> all;  // its items never move
    std::vector<std::uint8_t> wanted(octets.begin(), octets.end());
    const std::lock_guard lock(mutex);
    kept_ = &*all.insert(std::move(wanted)).first;
}

}  // namespace puckloop::cosim
