#include "bench/upload/boot_place.h"

#include <algorithm>
#include <numeric>

namespace puckloop::tools {

void BootPlace::sent(std::span<const std::uint8_t> octets) {
    recent_.insert(recent_.end(), octets.begin(), octets.end());
    if (recent_.size() >= kPacket)
        recent_.erase(recent_.begin(), recent_.end() - static_cast<std::ptrdiff_t>(kPacket - 1));
}

void BootPlace::lost(std::size_t most) {
    low_ = 0;
    high_ = std::min(most, kPacket - 1);
    fresh_ = true;
}

std::size_t BootPlace::middle() const {
    if (known()) return low_;
    return fresh_ ? low_ + 1 : (low_ + high_ + 1) / 2;
}

/// An octet with which the last 101 have a wrong sum. Neither value is a hello or the fourth octet of an end.
std::uint8_t BootPlace::filling() const {
    return std::accumulate(recent_.begin(), recent_.end(), 0U) % 256 == 0 ? 1 : 0;
}

BootPacket BootPlace::probe() {
    asked_ = middle();
    fresh_ = false;
    BootPacket octets;
    while (octets.size() < kPacket - asked_) {
        octets.push_back(filling());
        sent({&octets.back(), 1});
    }
    return octets;
}

void BootPlace::answered(bool yes) {
    if (yes) {
        high_ -= asked_;
        low_ = 0;
    } else {
        low_ += kPacket - asked_;
        high_ = kPacket - 1;
    }
}

}  // namespace puckloop::tools
