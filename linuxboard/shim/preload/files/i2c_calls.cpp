// read(), write() and the ioctls of /dev/i2c-N: checks and answers in the order of the kernel's
// drivers/i2c/i2c-dev.c, on an adapter as drivers/i2c/busses/i2c-omap.c gives it.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/files/i2c_transfer.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"

#include <limits.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

namespace puckloop::shim {

namespace {
constexpr unsigned long kHighestAddress = 0x7f;
constexpr unsigned long kHighestTenBitAddress = 0x3ff;
/// OMAP_I2C_TIMEOUT of drivers/i2c/busses/i2c-omap.c.
constexpr std::uint32_t kMessageTimeoutMs = 1000;
/// Of i2c-omap: no quick command, no block read.
constexpr unsigned long kFunctions =
    I2C_FUNC_I2C | (I2C_FUNC_SMBUS_EMUL & ~I2C_FUNC_SMBUS_QUICK) | I2C_FUNC_PROTOCOL_MANGLING;
constexpr std::size_t kMostTransferData = wire::kMaximumData - 1024;

/// Refuses what the adapter cannot do; 0, or -1 and errno.
int check(const OpenFile& file, const i2c_msg* messages, unsigned count) {
    std::size_t out = 0, in = 0;
    for (unsigned i = 0; i < count; ++i) {
        const i2c_msg& message = messages[i];
        if (message.len == 0) return fail(EINVAL);
        // i2c-omap does not know I2C_M_RECV_LEN: it reads as many bytes as the message has.
        constexpr int kKnown = I2C_M_RD | I2C_M_RECV_LEN | I2C_M_TEN;
        if ((message.flags & ~kKnown) != 0) {
            note("%s: I2C message flags 0x%x are not supported", file.path, message.flags);
            return fail(EOPNOTSUPP);
        }
        const bool reads = (message.flags & I2C_M_RD) != 0;
        out += sizeof(wire::I2cSegment) + (reads ? 0 : message.len);
        in += reads ? message.len : 0;
    }
    if (out <= kMostTransferData && in <= kMostTransferData) return 0;
    note("%s: an I2C transfer of more than %zu bytes is not supported", file.path, kMostTransferData);
    return fail(EOPNOTSUPP);
}

int rdwr(OpenFile& file, const void* argument) {
    i2c_rdwr_ioctl_data call{};
    if (!get_from_program(call, argument)) return -1;
    if (call.msgs == nullptr || call.nmsgs == 0 || call.nmsgs > I2C_RDWR_IOCTL_MAX_MSGS) return fail(EINVAL);
    i2c_msg theirs[I2C_RDWR_IOCTL_MAX_MSGS], ours[I2C_RDWR_IOCTL_MAX_MSGS];
    if (!copy_from_program(theirs, call.msgs, call.nmsgs * sizeof theirs[0])) return -1;
    std::vector<std::string> buffers(call.nmsgs);
    for (unsigned i = 0; i < call.nmsgs; ++i) {
        i2c_msg& message = ours[i] = theirs[i];
        if (message.len > kMostMessageBytes) return fail(EINVAL);
        buffers[i].resize(message.len);
        message.buf = reinterpret_cast<__u8*>(buffers[i].data());
        if (!copy_from_program(message.buf, theirs[i].buf, message.len)) return -1;
        if ((message.flags & I2C_M_RECV_LEN) == 0) continue;
        const bool reads = (message.flags & I2C_M_RD) != 0;
        if (!reads || message.len == 0 || message.buf[0] < 1 ||
            message.len < message.buf[0] + I2C_SMBUS_BLOCK_MAX)
            return fail(EINVAL);
        message.len = message.buf[0];
    }
    const int done = transfer(file, ours, call.nmsgs);
    for (unsigned i = 0; done >= 0 && i < call.nmsgs; ++i)
        if ((ours[i].flags & I2C_M_RD) != 0 && !copy_to_program(theirs[i].buf, ours[i].buf, ours[i].len))
            return -1;
    return done;
}

int set_slave(OpenFile& file, unsigned long address) {
    if (address > kHighestTenBitAddress || (!file.ten_bit && address > kHighestAddress)) return fail(EINVAL);
    file.slave = static_cast<std::uint16_t>(address);
    return 0;
}
}  // namespace

int transfer(OpenFile& file, i2c_msg* messages, unsigned count) {
    if (check(file, messages, count) != 0) return -1;
    std::string data, answer;
    for (unsigned i = 0; i < count; ++i) {
        const i2c_msg& message = messages[i];
        const bool reads = (message.flags & I2C_M_RD) != 0;
        const wire::I2cSegment segment{
            message.addr, static_cast<std::uint16_t>(message.flags & (I2C_M_RD | I2C_M_TEN)), message.len};
        data.append(reinterpret_cast<const char*>(&segment), sizeof segment);
        if (!reads) data.append(reinterpret_cast<const char*>(message.buf), message.len);
        if (reads) answer.resize(answer.size() + message.len);
    }
    wire::Request request;
    request.op = wire::Op::Transfer;
    request.handle = file.handle;
    request.a = kMessageTimeoutMs;
    request.b = count;
    std::size_t received = 0;
    const auto done = static_cast<int>(
        device_call(request, data.data(), data.size(), answer.data(), answer.size(), false, &received));
    if (done < 0) return -1;
    std::size_t used = 0;
    for (unsigned i = 0; i < count; ++i) {
        if ((messages[i].flags & I2C_M_RD) == 0) continue;
        const std::size_t length = std::min<std::size_t>(messages[i].len, received - used);
        std::memcpy(messages[i].buf, answer.data() + used, length);
        used += length;
    }
    return done;
}

std::int64_t read_i2c(OpenFile& file, void* buffer, std::size_t size) {
    std::string data(std::min(size, kMostMessageBytes), '\0');
    i2c_msg message{file.slave, static_cast<__u16>(I2C_M_RD | address_flags(file)),
                    static_cast<__u16>(data.size()), reinterpret_cast<__u8*>(data.data())};
    if (transfer(file, &message, 1) < 0) return -1;
    return copy_to_program(buffer, data.data(), data.size()) ? message.len : -1;
}

std::int64_t write_i2c(OpenFile& file, const void* data, std::size_t size) {
    std::string copy(std::min(size, kMostMessageBytes), '\0');
    if (!copy_from_program(copy.data(), data, copy.size())) return -1;
    i2c_msg message{file.slave, address_flags(file), static_cast<__u16>(copy.size()),
                    reinterpret_cast<__u8*>(copy.data())};
    return transfer(file, &message, 1) < 0 ? -1 : message.len;
}

int i2c_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller);

int i2c_ioctl(OpenFile& file, unsigned long request, void* argument, const void* caller) {
    const auto value = static_cast<unsigned long>(reinterpret_cast<std::uintptr_t>(argument));
    switch (request) {
    case I2C_SLAVE:
    case I2C_SLAVE_FORCE:
        return set_slave(file, value);
    case I2C_TENBIT:
        file.ten_bit = value != 0;
        return 0;
    case I2C_PEC:
        file.pec = value != 0;
        return 0;
    case I2C_FUNCS:
        return put_to_program(argument, kFunctions) ? 0 : -1;
    case I2C_RDWR:
        return rdwr(file, argument);
    case I2C_SMBUS:
        return smbus_ioctl(file, argument);
    case I2C_RETRIES:  // the driver retries lost arbitration only, which fails at once here
    case I2C_TIMEOUT:  // how long it retries; a message has the driver's own time
        return value > INT_MAX ? fail(EINVAL) : 0;
    default:
        note("%s: ioctl 0x%lx is not supported (in %s)", file.path, request, place_of(caller));
        return fail(ENOTTY);
    }
}

}  // namespace puckloop::shim
