#include "emu/i2c_devices/rgb_turret.h"

#include "emu/i2c_devices/signals.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

namespace puckloop::i2c_devices {

using cosim::I2cAnswer;

namespace {
constexpr std::size_t kLeds = 3;
constexpr std::size_t kColours = 3;
}  // namespace

I2cAnswer RgbTurret::start(bool, cosim::Time) {
    received_.clear();
    return {.acknowledge = true};
}

I2cAnswer RgbTurret::write(std::uint8_t byte, cosim::Time) {
    if (received_.size() <= kBytes) received_.push_back(byte);
    return {.acknowledge = true};
}

I2cAnswer RgbTurret::read(cosim::Time) {
    return {.acknowledge = true};
}

void RgbTurret::stop(cosim::Time, const Emit& emit) {
    if (received_.empty()) return;
    ++(received_.size() == kBytes ? frames_ : wrong_frames_);
    if (received_.size() == kBytes)
        for (std::size_t i = 0; i < kBytes; ++i) {
            const std::size_t led = kLeds - 1 - i / kColours;
            const std::size_t place = led * kColours + i % kColours;
            if (colours_[place] == received_[i]) continue;
            colours_[place] = received_[i];
            emit(static_cast<std::uint16_t>(kRgb + place), received_[i]);
        }
    received_.clear();
}

void RgbTurret::reset(const Emit& emit) {
    received_.clear();
    for (std::size_t place = 0; place < colours_.size(); ++place)
        if (std::exchange(colours_[place], 0) != 0) emit(static_cast<std::uint16_t>(kRgb + place), 0);
}

std::string RgbTurret::report() const {
    return fmt::format(R"({{"frames":{},"wrong_length":{},"colours":[{}]}})", frames_, wrong_frames_,
                       fmt::join(colours_, ","));
}

}  // namespace puckloop::i2c_devices
