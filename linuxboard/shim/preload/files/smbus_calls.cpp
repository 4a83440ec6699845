// I2C_SMBUS: the checks of the kernel's i2c-dev.c, and the plain I2C messages that i2c-core-smbus.c makes for
// an adapter without SMBus hardware, with the packet error code (a CRC-8) that it computes.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/files/i2c_transfer.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"

#include <cerrno>
#include <cstring>

namespace puckloop::shim {

namespace {
/// Longest SMBus message: command, count, block and packet error code.
constexpr std::size_t kSmbusBytes = I2C_SMBUS_BLOCK_MAX + 3;

bool is_known(__u32 size) {
    switch (size) {
    case I2C_SMBUS_QUICK:
    case I2C_SMBUS_BYTE:
    case I2C_SMBUS_BYTE_DATA:
    case I2C_SMBUS_WORD_DATA:
    case I2C_SMBUS_PROC_CALL:
    case I2C_SMBUS_BLOCK_DATA:
    case I2C_SMBUS_I2C_BLOCK_BROKEN:
    case I2C_SMBUS_BLOCK_PROC_CALL:
    case I2C_SMBUS_I2C_BLOCK_DATA:
        return true;
    default:
        return false;
    }
}

std::size_t bytes_of(__u32 size) {
    switch (size) {
    case I2C_SMBUS_BYTE:
    case I2C_SMBUS_BYTE_DATA:
        return sizeof i2c_smbus_data::byte;
    case I2C_SMBUS_WORD_DATA:
    case I2C_SMBUS_PROC_CALL:
        return sizeof i2c_smbus_data::word;
    default:
        return sizeof i2c_smbus_data::block;
    }
}

/// CRC-8 of SMBus (x^8 + x^2 + x + 1) over a message with its address byte.
__u8 packet_code(__u8 code, const i2c_msg& message) {
    constexpr unsigned kPolynomial = 0x107;
    const auto add = [&code](unsigned byte) {
        unsigned rest = (code ^ byte) & 0xff;
        for (int bit = 0; bit < 8; ++bit)
            rest = (rest << 1) ^ ((rest & 0x80) != 0 ? kPolynomial : 0);
        code = static_cast<__u8>(rest);
    };
    add(static_cast<unsigned>(message.addr) << 1 | ((message.flags & I2C_M_RD) != 0 ? 1u : 0u));
    for (unsigned i = 0; i < message.len; ++i)
        add(message.buf[i]);
    return code;
}

/// The messages of one SMBus transaction.
struct Messages {
    __u8 out[kSmbusBytes] = {};
    __u8 in[kSmbusBytes] = {};
    i2c_msg list[2] = {};
    unsigned count = 1;
};

/// Fills `made`; 0, or the errno value.
int make_messages(const OpenFile& file, bool reads, __u32 size, __u8 command, const i2c_smbus_data& data,
                  Messages& made) {
    made.out[0] = command;
    made.list[0] = {file.slave, address_flags(file), 1, made.out};
    made.list[1] = {file.slave, static_cast<__u16>(I2C_M_RD | address_flags(file)), 0, made.in};
    const auto read_after = [&made](unsigned length) {
        made.list[1].len = static_cast<__u16>(length);
        made.count = 2;
    };
    const auto write_block = [&made, &data](unsigned first, unsigned length) {
        std::memcpy(made.out + 1, data.block + first, length);
        made.list[0].len = static_cast<__u16>(length + 1);
    };
    const bool too_long = data.block[0] > I2C_SMBUS_BLOCK_MAX;
    switch (size) {
    case I2C_SMBUS_QUICK:  // without a byte, which i2c-omap refuses
        made.list[0].len = 0;
        made.list[0].flags = reads ? I2C_M_RD : 0;
        break;
    case I2C_SMBUS_BYTE:
        if (reads) made.list[0] = {file.slave, I2C_M_RD, 1, made.in};
        break;
    case I2C_SMBUS_BYTE_DATA:
        made.out[1] = data.byte;
        made.list[0].len = 2;
        if (reads) made.list[0].len = 1;
        if (reads) read_after(1);
        break;
    case I2C_SMBUS_WORD_DATA:
    case I2C_SMBUS_PROC_CALL:
        made.out[1] = static_cast<__u8>(data.word & 0xff);
        made.out[2] = static_cast<__u8>(data.word >> 8);
        made.list[0].len = 3;
        if (reads && size == I2C_SMBUS_WORD_DATA) made.list[0].len = 1;
        if (reads || size == I2C_SMBUS_PROC_CALL) read_after(2);
        break;
    case I2C_SMBUS_BLOCK_DATA:
        // A read: i2c-omap reads the count and no more.
        if (reads) {
            read_after(1);
        } else {
            if (too_long) return EINVAL;
            write_block(0, data.block[0] + 1u);
        }
        break;
    case I2C_SMBUS_BLOCK_PROC_CALL:
        if (too_long) return EINVAL;
        write_block(0, data.block[0] + 1u);
        read_after(1);
        break;
    default:  // I2C_SMBUS_I2C_BLOCK_DATA
        if (too_long) return EINVAL;
        if (reads) {
            read_after(data.block[0]);
        } else {
            write_block(1, data.block[0]);
        }
        break;
    }
    return 0;
}

/// What was read, as the caller finds it; 0, or the errno value.
int take_answer(__u32 size, const Messages& made, i2c_smbus_data& data) {
    switch (size) {
    case I2C_SMBUS_BYTE:
    case I2C_SMBUS_BYTE_DATA:
        data.byte = made.in[0];
        break;
    case I2C_SMBUS_WORD_DATA:
    case I2C_SMBUS_PROC_CALL:
        data.word = static_cast<__u16>(made.in[0] | made.in[1] << 8);
        break;
    case I2C_SMBUS_I2C_BLOCK_DATA:
        std::memcpy(data.block + 1, made.in, data.block[0]);
        break;
    case I2C_SMBUS_BLOCK_DATA:
    case I2C_SMBUS_BLOCK_PROC_CALL:
        if (made.in[0] > I2C_SMBUS_BLOCK_MAX) return EPROTO;
        std::memcpy(data.block, made.in, made.in[0] + 1u);
        break;
    default:
        break;
    }
    return 0;
}

/// As i2c_smbus_xfer_emulated(); 0, or the errno value.
int emulate(OpenFile& file, bool reads, __u32 size, __u8 command, i2c_smbus_data& data) {
    Messages made;
    if (const int error = make_messages(file, reads, size, command, data, made)) return error;
    const bool has_pec = file.pec && size != I2C_SMBUS_QUICK && size != I2C_SMBUS_I2C_BLOCK_DATA;
    i2c_msg& last = made.list[made.count - 1];
    __u8 code = 0;
    if (has_pec) {
        if (made.count == 2 || (last.flags & I2C_M_RD) == 0) code = packet_code(0, made.list[0]);
        if ((last.flags & I2C_M_RD) != 0) {
            ++last.len;
        } else {
            last.buf[last.len++] = code;
        }
    }
    if (transfer(file, made.list, made.count) < 0) return errno;
    if (has_pec && (last.flags & I2C_M_RD) != 0) {
        --last.len;
        if (packet_code(code, last) != last.buf[last.len]) return EBADMSG;
    }
    if (!reads && size != I2C_SMBUS_PROC_CALL && size != I2C_SMBUS_BLOCK_PROC_CALL) return 0;
    return take_answer(size, made, data);
}
}  // namespace

int smbus_ioctl(OpenFile& file, const void* argument) {
    i2c_smbus_ioctl_data call{};
    if (!get_from_program(call, argument)) return -1;
    if (!is_known(call.size) || call.read_write > 1) return fail(EINVAL);
    const bool reads = call.read_write == I2C_SMBUS_READ;
    i2c_smbus_data data{};
    const auto end = [](int error) { return error == 0 ? 0 : fail(error); };
    if (call.size == I2C_SMBUS_QUICK || (call.size == I2C_SMBUS_BYTE && !reads))
        return end(emulate(file, reads, call.size, call.command, data));
    if (call.data == nullptr) return fail(EINVAL);
    const bool both = call.size == I2C_SMBUS_PROC_CALL || call.size == I2C_SMBUS_BLOCK_PROC_CALL;
    const std::size_t bytes = bytes_of(call.size);
    if ((both || call.size == I2C_SMBUS_I2C_BLOCK_DATA || !reads) &&
        !copy_from_program(&data, call.data, bytes))
        return -1;
    __u32 size = call.size;
    if (size == I2C_SMBUS_I2C_BLOCK_BROKEN) {
        size = I2C_SMBUS_I2C_BLOCK_DATA;
        if (reads) data.block[0] = I2C_SMBUS_BLOCK_MAX;
    }
    if (const int error = emulate(file, reads, size, call.command, data)) return fail(error);
    return (reads || both) && !copy_to_program(call.data, &data, bytes) ? -1 : 0;
}

}  // namespace puckloop::shim
