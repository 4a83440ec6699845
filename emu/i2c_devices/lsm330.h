#pragma once
// The LSM330 of main boards from revision 1.3 on: two dies in one package, an accelerometer at 0x1E and a
// gyroscope at 0x6A, each a device of its own. Axes on the robot: x forward, y left, z up.
// Sources: ST DocID 023426 (LSM330), sections 5 (bus), 7 and 8 (registers); e-puck library, e_lsm330.c.
//
// Deviations:
// 1. Each sample is what the body does at its instant, with white noise of the data sheet's density over the
//    bandwidth set; no filter delays it, no time for the gyroscope to start is needed.
// 2. FIFO, high-pass filter, state machines, interrupts, self-test and offset registers keep what is written
//    and do nothing else: report() names those that were written with something other than their default.
// 3. The output rates are exact. 4. OUT_TEMP_G is always 25.

#include "base/random.h"
#include "cosim/core/marked.h"
#include "cosim/i2c/i2c_slave.h"

#include <array>
#include <bitset>
#include <string>

namespace puckloop::i2c_devices {

class Lsm330 final : public cosim::I2cSlave {
  public:
    enum class Die : std::uint8_t { Accelerometer, Gyroscope };
    static constexpr std::uint8_t kAccelerometerAddress = 0x1E, kGyroscopeAddress = 0x6A;

    /// `seed` and `name`, the bus's, make the die's random stream.
    Lsm330(Die die, std::uint64_t seed, const std::string& name);

    std::string_view name() const override;
    bool listens_to(std::uint8_t address) const override;
    cosim::I2cAnswer start(bool read, cosim::Time now) override;
    cosim::I2cAnswer write(std::uint8_t byte, cosim::Time now) override;
    cosim::I2cAnswer read(cosim::Time now) override;
    /// Power comes back: every register has its default, and it sleeps.
    void reset(const Emit& emit) override;
    void signal_at(std::uint16_t id, double value, cosim::Time now) override;
    std::string report() const override;
    cosim::Rewindable* rewindable() override { return &mark_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(noise_, registers_, register_, number_next_, increments_, felt_, output_, held_, period_,
                next_, samples_, reads_);
    }

  private:
    static constexpr std::size_t kRegisters = 128, kAxes = 3;

    void set_defaults();
    void set_rate(cosim::Time now);
    void pass(cosim::Time now);
    void take();
    void write_register(std::uint8_t number, std::uint8_t value, cosim::Time now);
    std::uint8_t read_register(std::uint8_t number);
    void axis_read(std::size_t axis);
    bool gyroscope() const { return die_ == Die::Gyroscope; }
    double digit() const;
    double noise_rms() const;
    bool increments(std::uint8_t sub_address) const;

    Die die_;
    RandomStream noise_;
    std::array<std::uint8_t, kRegisters> registers_{};
    std::uint8_t register_ = 0;
    bool number_next_ = false, increments_ = false;
    std::array<double, kAxes> felt_{};  ///< g, or degrees a second
    std::array<std::int16_t, kAxes> output_{};
    std::uint8_t held_ = 0;   ///< axes half read, with block data update
    cosim::Time period_ = 0;  ///< of the samples; 0: asleep
    cosim::Time next_ = 0;    ///< sample
    std::uint64_t samples_ = 0, reads_ = 0;
    cosim::Marked<Lsm330> mark_{*this};
};

}  // namespace puckloop::i2c_devices
