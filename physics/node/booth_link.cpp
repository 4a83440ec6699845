#include "physics/node/booth_link.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::physics {

namespace {

constexpr std::uint16_t kUnused = 0xFFFF;
constexpr double kBeamQuantum = 1e-3;  // share of a beam

}  // namespace

BoothLink::BoothLink(const Booth& booth, cosim::PortIndex port) : port_(port) {
    const auto id_of = [&](const std::string& name) {
        const auto found = booth.signals.find(name);
        return found == booth.signals.end() ? kUnused : found->second;
    };
    barriers_ = {id_of("barrier_front"), id_of("barrier_back")};
    constexpr std::array<const char*, 3> kColours{"red", "green", "blue"};
    for (std::size_t light = 0; light < booth::kLights; ++light)
        for (std::size_t colour = 0; colour < kColours.size(); ++colour)
            if (const auto id = id_of(fmt::format("led_{}_{}", booth::kLight[light].name, kColours[colour]));
                id != kUnused)
                leds_[id] = {light, colour};
}

void BoothLink::take(const cosim::Signal& signal, BoothModel& booth) const {
    if (const auto led = leds_.find(signal.id); led != leds_.end())
        booth.shine(led->second.light, led->second.colour, signal.value);
}

void BoothLink::publish(const BoothModel& booth, cosim::Time time, std::vector<cosim::Message>& outbox) {
    for (std::size_t i = 0; i < barriers_.size(); ++i) {
        const double value = std::round(booth.barriers[i] / kBeamQuantum) * kBeamQuantum;
        if (value == last_[i] || barriers_[i] == kUnused) continue;
        last_[i] = value;
        outbox.push_back({time, port_, cosim::Signal{barriers_[i], value}});
    }
}

}  // namespace puckloop::physics
