// Registers, flags, RAM and modules as many turns see them.

#include "emu/avr/fast/lane_walk.h"

#include <algorithm>
#include <utility>

namespace puckloop::avr {

namespace {

constexpr std::uint16_t kIoStart = 0x20, kRampz = 0x5B, kSpl = 0x5D, kSph = 0x5E, kSreg = 0x5F;

}  // namespace

Lanes LaneWalk::reg(unsigned number) {
    const std::uint32_t bit = 1u << number;
    if (!((read_ | written_) & bit)) {
        r_[number] = Lanes(m_.data[number]);
        read_ |= bit;
    }
    return r_[number];
}

void LaneWalk::set(unsigned number, const Lanes& value) {
    r_[number] = value;
    written_ |= 1u << number;
}

Lanes LaneWalk::flags(std::uint8_t mask) {
    flags_read_ |= static_cast<std::uint8_t>(mask & ~flags_written_);
    return sreg_ & mask;
}

void LaneWalk::set_flags(std::uint8_t mask, const Lanes& value) {
    flags_written_ |= mask;
    sreg_ = (sreg_ & static_cast<std::uint8_t>(~mask)) | value;
}

std::uint8_t LaneWalk::uniform(const Lanes& value) {
    const std::uint8_t first = value[0];
    cut(~(value ^ Lanes(first)).zeros());
    return first;
}

bool LaneWalk::zero(const Lanes& value) {
    const std::uint64_t zeros = value.zeros();
    const bool first = zeros & 1;
    cut(first ? ~zeros : zeros);
    return first;
}

std::uint16_t LaneWalk::pointer(unsigned low) {
    const std::uint8_t low_byte = uniform(reg(low));
    return static_cast<std::uint16_t>(uniform(reg(low + 1)) << 8 | low_byte);
}

/// The address that an access by pointer uses; the pointer moves.
std::uint16_t LaneWalk::moved_pointer(unsigned low, int before, int after) {
    const auto at = static_cast<std::uint16_t>(pointer(low) + before);
    const auto end = static_cast<std::uint16_t>(at + after);
    set(low, Lanes(static_cast<std::uint8_t>(end)));
    set(low + 1, Lanes(static_cast<std::uint8_t>(end >> 8)));
    return at;
}

LaneWalk::Cell& LaneWalk::cell(std::uint16_t address) {
    for (std::size_t i = 0; i < cells_; ++i)
        if (cell_[i].address == address) return cell_[i];
    if (cells_ == kMostCells) fail(Verdict::NotNow);
    Cell& fresh = cell_[cells_++];
    fresh.address = address;
    fresh.read = fresh.written = false;
    return fresh;
}

Lanes LaneWalk::load(const Op* op, std::uint16_t address) {
    if (address - m_.ram_start < m_.ram_bytes) {
        Cell& place = cell(address);
        if (!place.read && !place.written) {
            place.value = Lanes(m_.data[address]);
            place.read = true;
        }
        return place.value;
    }
    if (address < kIoStart) return reg(address);
    if (address >= m_.ram_start) fail(Verdict::NotNow);
    return load_module(op, address);
}

Lanes LaneWalk::load_module(const Op* op, std::uint16_t address) {
    const Cycle at = offset_ + op->cycles - 1;
    access_ = at;
    switch (address) {
    case kSreg:
        return flags(0xFF);
    case kSpl:
        return Lanes(static_cast<std::uint8_t>(sp_));
    case kSph:
        return Lanes(static_cast<std::uint8_t>(sp_ >> 8));
    case kRampz:
        return Lanes(m_.rampz);
    default:
        break;
    }
    if (m_.io.steady_read(address)) {
        polled_ = address;
        const Cycle now = std::exchange(m_.now, base_ + at);
        const std::uint8_t value = m_.io.read(address);
        m_.now = now;
        return Lanes(value);
    }
    std::array<std::uint8_t, Lanes::kCount> values{};
    const std::size_t known = m_.io.follow(address, base_ + at, period_, values);
    if (known == 0 || reads_ == kMostReads) fail(Verdict::NotNow);
    valid_ = std::min(valid_, known);
    follows_ = true;
    read_at_[reads_++] = {address, at};
    return Lanes::of(values);
}

void LaneWalk::store(const Op* op, std::uint16_t address, const Lanes& value) {
    if (address - m_.ram_start < m_.ram_bytes) {
        Cell& place = cell(address);
        place.value = value;
        place.written = true;
    } else if (address < kIoStart) {
        set(address, value);
    } else if (address == kSreg) {
        access_ = offset_ + op->cycles - 1;
        write_flags(op, value, 0xFF);
    } else {
        fail(Verdict::Never);
    }
}

/// As write_sreg() of the interpreter: setting I holds interrupts back for one instruction.
void LaneWalk::write_flags(const Op* op, const Lanes& value, std::uint8_t mask) {
    if (mask & sreg::I) {
        const bool was_off = zero(flags(sreg::I)), is_off = zero(value & sreg::I);
        if (was_off && !is_off) hold_ = offset_ + op->cycles;
    }
    set_flags(mask, value & mask);
}

void LaneWalk::compare_ends() {
    std::uint64_t different = 0;
    for (std::uint32_t carried = read_ & written_; carried; carried &= carried - 1) {
        const auto number = static_cast<std::size_t>(std::countr_zero(carried));
        different |= ~(r_[number] ^ Lanes(m_.data[number])).zeros();
    }
    if (const auto carried = static_cast<std::uint8_t>(flags_read_ & flags_written_))
        different |= ~((sreg_ ^ Lanes(m_.sreg)) & carried).zeros();
    for (std::size_t i = 0; i < cells_; ++i)
        if (cell_[i].read && cell_[i].written)
            different |= ~(cell_[i].value ^ Lanes(m_.data[cell_[i].address])).zeros();
    if (sp_ != m_.sp) different |= 1;
    // A turn that ends otherwise was itself right.
    if (different) valid_ = std::min(valid_, static_cast<std::size_t>(std::countr_zero(different)) + 1);
}

void LaneWalk::commit(std::size_t last, std::uint64_t turns) {
    for (std::uint32_t changed = written_; changed; changed &= changed - 1) {
        const auto number = static_cast<std::size_t>(std::countr_zero(changed));
        m_.data[number] = r_[number][last];
    }
    for (std::size_t i = 0; i < cells_; ++i)
        if (cell_[i].written) m_.data[cell_[i].address] = cell_[i].value[last];
    m_.sreg = sreg_[last];
    m_.sp = sp_;
    const Cycle start = base_ + (turns - 1) * offset_;  // of the last turn
    for (std::size_t i = 0; i < reads_; ++i) {
        m_.now = start + read_at_[i].offset;
        m_.io.read(read_at_[i].address);
    }
    if (access_ != kNoCycle) m_.now = start + access_;
    if (hold_ != kNoCycle) m_.hold_at = start + hold_;
    if (m_.events.next() < m_.limit) m_.limit = m_.events.next();
    m_.cycle = start + offset_;
    m_.instructions += turns * instructions_;
    m_.skipped += turns * offset_;
}

}  // namespace puckloop::avr
