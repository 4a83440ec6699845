#pragma once
// A device that is a row of 8-bit registers: the first byte written is the register number, more bytes go to
// registers from there on, reads come from the current register on; both count it up.

#include "cosim/i2c/i2c_slave.h"

namespace puckloop::i2c_devices {

class RegisterDevice : public cosim::I2cSlave {
  public:
    explicit RegisterDevice(std::uint8_t address) : address_(address) {}

    bool listens_to(std::uint8_t address) const override { return address == address_; }
    cosim::I2cAnswer start(bool read, cosim::Time now) override;
    cosim::I2cAnswer write(std::uint8_t byte, cosim::Time now) override;
    cosim::I2cAnswer read(cosim::Time now) override;
    void reset(const Emit& emit) override;

    template <class Archive>
    void state(Archive& archive) {
        archive(register_, number_next_);
    }

  protected:
    virtual std::uint8_t read_register(std::uint8_t number) = 0;
    /// False: not acknowledged.
    virtual bool write_register(std::uint8_t number, std::uint8_t value) = 0;

  private:
    std::uint8_t address_;
    std::uint8_t register_ = 0;
    bool number_next_ = false;
};

}  // namespace puckloop::i2c_devices
