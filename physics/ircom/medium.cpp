#include "physics/ircom/medium.h"

#include <algorithm>
#include <array>

namespace puckloop::physics {

IrcomMedium::IrcomMedium(const World& world, bool changes)
    : scene_(world, changes),
      lit_(scene_.device_count()),
      light_(scene_.device_count() * kProximitySensors),
      sum_(light_.size()) {}

void IrcomMedium::set(std::size_t device, std::size_t line, bool lit) {
    const auto bit = static_cast<std::uint8_t>(1U << line);
    lit_[device] = static_cast<std::uint8_t>(lit ? lit_[device] | bit : lit_[device] & ~bit);
}

bool IrcomMedium::any_lit() const {
    return std::any_of(lit_.begin(), lit_.end(), [](std::uint8_t lines) { return lines != 0; }) ||
           std::any_of(copies_.begin(), copies_.end(), [](const IrcomCopy& one) { return one.lines != 0; });
}

void IrcomMedium::expect_faults(std::vector<IrcomCopy> copies) {
    copies_ = std::move(copies);
    blocks_.assign(lit_.size() * lit_.size(), 0);
}

void IrcomMedium::block(std::size_t sender, std::size_t receiver, bool on) {
    std::uint16_t& count = blocks_[sender * lit_.size() + receiver];
    count = static_cast<std::uint16_t>(count + (on ? 1 : -1));
}

double IrcomMedium::brightest(std::size_t device) const {
    const auto first = light_.begin() + static_cast<std::ptrdiff_t>(device * kProximitySensors);
    return *std::max_element(first, first + kProximitySensors);
}

double IrcomMedium::from(std::size_t sender, std::size_t receiver) const {
    std::array<double, kProximitySensors> sum{};
    for (std::size_t line = 0; line < scene_.lines(sender); ++line) {
        if ((lit_[sender] >> line & 1U) == 0) continue;
        for (const IrcomShare& share : scene_.light_of(sender, line))
            if (share.device == receiver) sum[share.sensor] += share.counts;
    }
    return *std::max_element(sum.begin(), sum.end());
}

void IrcomMedium::update(std::vector<IrcomLight>& changed) {
    std::fill(sum_.begin(), sum_.end(), 0.0);
    for (std::size_t d = 0; d < lit_.size(); ++d)
        for (std::size_t line = 0; lit_[d] >> line != 0; ++line) {
            if ((lit_[d] >> line & 1U) == 0) continue;
            for (const IrcomShare& share : scene_.light_of(d, line))
                if (!blocked(d, share.device))
                    sum_[share.device * kProximitySensors + share.sensor] += share.counts;
        }
    for (const IrcomCopy& copy : copies_)
        for (std::size_t line = 0; copy.lines >> line != 0; ++line) {
            if ((copy.lines >> line & 1U) == 0) continue;
            for (const IrcomShare& share : scene_.light_of(copy.device, line))
                if (copy.to.value_or(share.device) == share.device)
                    sum_[share.device * kProximitySensors + share.sensor] += share.counts;
        }
    for (std::size_t i = 0; i < sum_.size(); ++i) {
        if (sum_[i] == light_[i]) continue;
        light_[i] = sum_[i];
        changed.push_back({i / kProximitySensors, i % kProximitySensors, sum_[i]});
    }
}

}  // namespace puckloop::physics
