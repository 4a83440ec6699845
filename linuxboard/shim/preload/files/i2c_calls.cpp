// The ioctls of /dev/i2c-N (Documentation/i2c/dev-interface). SMBus calls become plain I2C messages, as the
// kernel does for an adapter without SMBus hardware.

#include "linuxboard/shim/preload/files/open_file.h"

#include <linux/i2c-dev.h>
#include <linux/i2c.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace puckloop::shim {

namespace {
constexpr unsigned kHighestAddress = 0x7f;
constexpr std::uint32_t kTimeoutUnitMs = 10;
constexpr unsigned long kFunctions =
    I2C_FUNC_I2C | (I2C_FUNC_SMBUS_EMUL & ~I2C_FUNC_SMBUS_PEC) | I2C_FUNC_SMBUS_READ_BLOCK_DATA;
/// Longest SMBus message: command, count and block.
constexpr std::size_t kSmbusBytes = I2C_SMBUS_BLOCK_MAX + 2;

int smbus(OpenFile& file, const i2c_smbus_ioctl_data& call) {
    const bool reads = call.read_write == I2C_SMBUS_READ;
    __u8 out[kSmbusBytes] = {call.command};
    __u8 in[kSmbusBytes] = {};
    i2c_msg messages[2] = {{file.slave, 0, 1, out}, {file.slave, I2C_M_RD, 0, in}};
    unsigned count = 1;
    i2c_smbus_data* data = call.data;
    const auto write_then_read = [&](unsigned length) {
        messages[1].len = static_cast<__u16>(length);
        count = 2;
    };
    switch (call.size) {
    case I2C_SMBUS_QUICK:
        messages[0].len = 0;
        messages[0].flags = reads ? I2C_M_RD : 0;
        break;
    case I2C_SMBUS_BYTE:
        if (reads) {
            messages[0] = {file.slave, I2C_M_RD, 1, in};
        }
        break;
    case I2C_SMBUS_BYTE_DATA:
        if (reads) {
            write_then_read(1);
        } else {
            out[1] = data->byte;
            messages[0].len = 2;
        }
        break;
    case I2C_SMBUS_WORD_DATA:
    case I2C_SMBUS_PROC_CALL:
        if (!reads || call.size == I2C_SMBUS_PROC_CALL) {
            out[1] = static_cast<__u8>(data->word & 0xff);
            out[2] = static_cast<__u8>(data->word >> 8);
            messages[0].len = 3;
        }
        if (reads || call.size == I2C_SMBUS_PROC_CALL) write_then_read(2);
        break;
    case I2C_SMBUS_BLOCK_DATA:
        if (reads) {
            write_then_read(1);
            messages[1].flags |= I2C_M_RECV_LEN;
        } else {
            const __u8 length = std::min<__u8>(data->block[0], I2C_SMBUS_BLOCK_MAX);
            std::memcpy(out + 1, data->block, length + 1u);
            messages[0].len = static_cast<__u16>(length + 2);
        }
        break;
    case I2C_SMBUS_I2C_BLOCK_DATA:
    case I2C_SMBUS_I2C_BLOCK_BROKEN: {
        const __u8 length = std::min<__u8>(data->block[0], I2C_SMBUS_BLOCK_MAX);
        if (reads) {
            write_then_read(length);
        } else {
            std::memcpy(out + 1, data->block + 1, length);
            messages[0].len = static_cast<__u16>(length + 1);
        }
        break;
    }
    default:
        note("%s: SMBus transaction %u is not supported", file.path, call.size);
        errno = EOPNOTSUPP;
        return -1;
    }
    if (transfer(file, messages, count) < 0) return -1;
    if (data == nullptr || (!reads && call.size != I2C_SMBUS_PROC_CALL)) return 0;
    switch (call.size) {
    case I2C_SMBUS_BYTE:
    case I2C_SMBUS_BYTE_DATA:
        data->byte = in[0];
        break;
    case I2C_SMBUS_WORD_DATA:
    case I2C_SMBUS_PROC_CALL:
        data->word = static_cast<__u16>(in[0] | in[1] << 8);
        break;
    case I2C_SMBUS_BLOCK_DATA:
        std::memcpy(data->block, in, I2C_SMBUS_BLOCK_MAX + 1);
        break;
    case I2C_SMBUS_I2C_BLOCK_DATA:
    case I2C_SMBUS_I2C_BLOCK_BROKEN:
        data->block[0] = static_cast<__u8>(messages[1].len);
        std::memcpy(data->block + 1, in, messages[1].len);
        break;
    default:
        break;
    }
    return 0;
}
}  // namespace

int i2c_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller);

int i2c_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller) {
    const auto value = static_cast<unsigned long>(reinterpret_cast<std::uintptr_t>(argument));
    switch (request) {
    case I2C_SLAVE:
    case I2C_SLAVE_FORCE:
        if (value > kHighestAddress) {
            errno = EINVAL;
            return -1;
        }
        file.slave = static_cast<std::uint16_t>(value);
        return 0;
    case I2C_FUNCS:
        *static_cast<unsigned long*>(argument) = kFunctions;
        return 0;
    case I2C_RDWR: {
        const auto* data = static_cast<const i2c_rdwr_ioctl_data*>(argument);
        if (data->nmsgs > I2C_RDWR_IOCTL_MAX_MSGS || data->msgs == nullptr) {
            errno = EINVAL;
            return -1;
        }
        return transfer(file, data->msgs, data->nmsgs);
    }
    case I2C_SMBUS:
        return smbus(file, *static_cast<const i2c_smbus_ioctl_data*>(argument));
    case I2C_TIMEOUT:
        file.timeout_ms = static_cast<std::uint32_t>(value) * kTimeoutUnitMs;
        return 0;
    case I2C_RETRIES:
        return 0;  // the driver retries lost arbitration only, which fails at once here
    case I2C_TENBIT:
    case I2C_PEC:
        if (value == 0) return 0;
        [[fallthrough]];
    default:
        note("%s: ioctl 0x%lx is not supported (in %s)", file.path, request, place_of(caller));
        errno = request == I2C_TENBIT ? EINVAL : ENOTTY;
        return -1;
    }
}

}  // namespace puckloop::shim
