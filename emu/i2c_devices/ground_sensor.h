#pragma once
// The ground sensor board at 0x60: what its three sensors see, as 16-bit big-endian registers. Source: e-puck
// facts 2.2.
//
// Deviations: 1. a register shows the newest value (the board samples faster than anybody asks). 2. The older
// board: cliff registers 13..16 read 0. 3. Revision 12 reads kRevision: no published figure.

#include "cosim/core/marked.h"
#include "emu/i2c_devices/register_device.h"

#include <array>

namespace puckloop::i2c_devices {

inline constexpr std::uint8_t kGroundSensorAddress = 0x60;

class GroundSensor final : public RegisterDevice {
  public:
    static constexpr std::uint8_t kReflected = 0;  ///< 6: left, centre, right, high byte first
    static constexpr std::uint8_t kAmbient = 6;    ///< 6: the same with the emitters off
    static constexpr std::uint8_t kRevisionRegister = 12;
    static constexpr std::uint8_t kRevision = 1;

    explicit GroundSensor(std::uint8_t address = kGroundSensorAddress) : RegisterDevice(address) {}

    std::string_view name() const override { return "ground_sensor"; }
    void signal(std::uint16_t id, double value) override;
    std::string report() const override;
    cosim::Rewindable* rewindable() override { return &mark_; }
    template <class Archive>
    void state(Archive& archive) {
        RegisterDevice::state(archive);
        archive(counts_, reads_);
    }

  private:
    std::uint8_t read_register(std::uint8_t number) override;
    bool write_register(std::uint8_t number, std::uint8_t value) override;

    std::array<std::uint16_t, 6> counts_{};  // reflected, ambient
    std::uint64_t reads_ = 0;
    cosim::Marked<GroundSensor> mark_{*this};
};

}  // namespace puckloop::i2c_devices
