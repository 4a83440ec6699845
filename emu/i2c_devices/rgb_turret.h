#pragma once
// The RGB LED turret at 0x61: nine bytes without a register number, LED 2, 1, 0, each red, green, blue.
// Source: e-puck facts 2.2. The colours show as signals rgb0_red .. rgb2_blue.
//
// Deviations: 1. a message of another length changes nothing (the board's answer to it is not known).
// 2. Reads give 0xFF.

#include "cosim/core/marked.h"
#include "cosim/i2c/i2c_slave.h"

#include <array>
#include <vector>

namespace puckloop::i2c_devices {

inline constexpr std::uint8_t kRgbTurretAddress = 0x61;

class RgbTurret final : public cosim::I2cSlave {
  public:
    static constexpr std::size_t kBytes = 9;

    explicit RgbTurret(std::uint8_t address = kRgbTurretAddress) : address_(address) {}

    std::string_view name() const override { return "rgb_turret"; }
    bool listens_to(std::uint8_t address) const override { return address == address_; }
    cosim::I2cAnswer start(bool read, cosim::Time now) override;
    cosim::I2cAnswer write(std::uint8_t byte, cosim::Time now) override;
    cosim::I2cAnswer read(cosim::Time now) override;
    void stop(cosim::Time now, const Emit& emit) override;
    /// All dark.
    void reset(const Emit& emit) override;
    std::string report() const override;
    cosim::Rewindable* rewindable() override { return &mark_; }
    template <class Archive>
    void state(Archive& archive) {
        archive(received_, colours_, frames_, wrong_frames_);
    }

  private:
    std::uint8_t address_;
    std::vector<std::uint8_t> received_;
    std::array<std::uint8_t, kBytes> colours_{};  // LED 0 red, green, blue, LED 1 ...
    std::uint64_t frames_ = 0, wrong_frames_ = 0;
    cosim::Marked<RgbTurret> mark_{*this};
};

}  // namespace puckloop::i2c_devices
