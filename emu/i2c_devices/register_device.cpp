#include "emu/i2c_devices/register_device.h"

namespace puckloop::i2c_devices {

using cosim::I2cAnswer;

I2cAnswer RegisterDevice::start(bool read, cosim::Time) {
    number_next_ = !read;
    return {.acknowledge = true};
}

void RegisterDevice::reset(const Emit&) {
    register_ = 0;
    number_next_ = false;
}

I2cAnswer RegisterDevice::write(std::uint8_t byte, cosim::Time) {
    if (number_next_) {
        number_next_ = false;
        register_ = byte;
        return {.acknowledge = true};
    }
    return {.acknowledge = write_register(register_++, byte)};
}

I2cAnswer RegisterDevice::read(cosim::Time) {
    return {.acknowledge = true, .byte = read_register(register_++)};
}

}  // namespace puckloop::i2c_devices
