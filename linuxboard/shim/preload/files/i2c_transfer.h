#pragma once
// What i2c-dev (i2c_calls.cpp) and SMBus (smbus_calls.cpp) share: messages to the adapter.

#include "linuxboard/shim/preload/descriptors/open_file.h"

#include <linux/i2c-dev.h>
#include <linux/i2c.h>

namespace puckloop::shim {

/// i2c-dev takes messages of so many bytes.
inline constexpr std::size_t kMostMessageBytes = 8192;

/// Of messages to the file's slave: I2C_M_TEN after the ioctl I2C_TENBIT.
inline __u16 address_flags(const OpenFile& file) {
    return file.ten_bit ? I2C_M_TEN : 0;
}

/// One or several messages whose buffers are this library's; number of messages done, or -1 and errno.
int transfer(OpenFile& file, i2c_msg* messages, unsigned count);

/// The ioctl I2C_SMBUS.
int smbus_ioctl(OpenFile& file, const void* argument);

}  // namespace puckloop::shim
