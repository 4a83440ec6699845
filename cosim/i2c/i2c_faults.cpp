#include "cosim/i2c/i2c_faults.h"

#include "base/error.h"
#include "cosim/i2c/i2c_figures.h"
#include "cosim/trace/trace_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::cosim {

namespace {

constexpr int kBits = 8;

/// The bits behind bit `k` on the wire are 1: nobody drives them any more.
std::uint8_t given_up_at(std::uint8_t byte, int k) {
    const unsigned behind = (1u << k) - 1;
    return static_cast<std::uint8_t>((byte & ~(1u << k)) | behind);
}

}  // namespace

I2cFaults::I2cFaults(std::vector<CarriedFault> faults, std::vector<std::string> masters, Time nominal)
    : carried_(std::move(faults)), masters_(std::move(masters)), nominal_(nominal) {
    for (const CarriedFault& carried : carried_) {
        Fault fault;
        fault.what = read_i2c_fault(carried.spec);
        if (const std::string& master = fault.what.where.master; !master.empty()) {
            const auto found = std::find(masters_.begin(), masters_.end(), master);
            if (found == masters_.end())
                throw InputError("", fmt::format("{} fault on {}", carried.spec.kind, carried.spec.link),
                                 fmt::format("no master '{}' on the bus", master));
            fault.master = static_cast<PortIndex>(found - masters_.begin());
        }
        if (fault.what.timed) {
            fault.low_from = carried.spec.begin;
            fault.low_until = later(carried.spec.begin, fault.what.time);
        }
        if (is_incomplete(fault.what.kind)) fault.next = carried.trigger.instant(0);
        faults_.push_back(fault);
    }
}

std::optional<std::uint8_t> I2cFaults::current_register() const {
    if (position_ == 0 && !reading_) return std::nullopt;
    const auto found = pointers_.find(address_);
    if (found == pointers_.end()) return std::nullopt;
    return found->second;
}

void I2cFaults::track(const I2cPhase& phase) {
    ++phases_;
    if (phase.kind == I2cPhaseKind::Start) {
        address_ = static_cast<std::uint8_t>(phase.byte >> 1);
        reading_ = (phase.byte & kReadBit) != 0;
        position_ = 0;
        return;
    }
    ++position_;
    if (phase.kind == I2cPhaseKind::Write && position_ == 1) pointers_[address_] = phase.byte;
}

bool I2cFaults::meant(const Fault& fault, PortIndex master, const I2cPhase& phase) const {
    const I2cWhere& where = fault.what.where;
    if (is_incomplete(fault.what.kind) || fault.what.timed) return false;
    if (!where.master.empty() && master != fault.master) return false;
    if (where.address && *where.address != address_) return false;
    if (where.reg && current_register() != where.reg) return false;
    if (where.position && *where.position != position_) return false;
    switch (where.bytes) {
    case I2cBytes::Address:
        if (phase.kind != I2cPhaseKind::Start) return false;
        break;
    case I2cBytes::Write:
        if (phase.kind != I2cPhaseKind::Write) return false;
        break;
    case I2cBytes::Read:
        if (phase.kind != I2cPhaseKind::Read) return false;
        break;
    case I2cBytes::Any:
        break;
    }
    const bool start = phase.kind == I2cPhaseKind::Start;
    switch (fault.what.kind) {
    case I2cFaultKind::Nack:  // a byte read is acknowledged by the master
        return phase.kind != I2cPhaseKind::Read;
    case I2cFaultKind::LoseArbitration:  // nobody can take a 0 from a master
        return phase.kind != I2cPhaseKind::Read &&
               (fault.what.bit ? (phase.byte >> *fault.what.bit & 1) != 0 : phase.byte != 0);
    case I2cFaultKind::Flip:
        return !start || fault.what.bit != 0;
    case I2cFaultKind::Start:
    case I2cFaultKind::Stop:
        return !start;
    case I2cFaultKind::Sda:
    case I2cFaultKind::Scl:  // is low as it is
        return fault.low_from == kNever || phase.start >= fault.low_until;
    default:
        return true;
    }
}

I2cDamage I2cFaults::strike(PortIndex master, const I2cPhase& phase) {
    note_quiet(phase.start, false);
    track(phase);
    I2cDamage damage;
    damage.phase = phase;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        const bool struck = meant(faults_[i], master, phase) && carried_[i].trigger.fires(phase.start);
        if (struck) harm(i, master, phase, damage);
        if (faults_[i].low_from < kNever && pull(faults_[i], phase, damage))
            pulled(i, master, phase);
        else if (struck && faults_[i].low_from == phase.start)
            pulled(i, master, phase, " between two samples of the line");
    }
    const auto deaf = deaf_.find(address_);
    if (phase.kind == I2cPhaseKind::Start && deaf != deaf_.end() && phase.start < deaf->second)
        damage.refused = true;
    return damage;
}

void I2cFaults::harm(std::size_t index, PortIndex master, const I2cPhase& phase, I2cDamage& damage) {
    Fault& fault = faults_[index];
    const I2cFault& what = fault.what;
    RandomStream& random = carried_[index].trigger.random();
    int bit = -1;
    std::string more;
    switch (what.kind) {
    case I2cFaultKind::Nack:
        damage.refused = true;
        break;
    case I2cFaultKind::Sda:
    case I2cFaultKind::Scl:
        fault.low_from = phase.start;
        fault.low_until = later(phase.start, what.time);
        return;  // pull() finds out what that does
    case I2cFaultKind::Stretch:
        damage.hold += what.time;
        break;
    case I2cFaultKind::LoseArbitration:
        bit = lose_at_bit(index, phase, damage);
        more = fmt::format(" until {}", format_seconds(damage.busy_until));
        break;
    case I2cFaultKind::Flip: {
        const bool address = phase.kind == I2cPhaseKind::Start;
        const int lowest = address ? 1 : 0;
        bit = what.bit ? *what.bit
                       : lowest + static_cast<int>(random.below(static_cast<std::uint64_t>(kBits - lowest)));
        const auto mask = static_cast<std::uint8_t>(1u << bit);
        if (phase.kind == I2cPhaseKind::Read)
            damage.flipped ^= mask;
        else
            damage.phase.byte ^= mask;
        break;
    }
    case I2cFaultKind::Start:
        // Clocked for a read, SDA is high: no device is at such an address.
        (phase.kind == I2cPhaseKind::Write ? damage.restarted : damage.stopped) = true;
        break;
    case I2cFaultKind::Stop:
        damage.stopped = true;
        break;
    case I2cFaultKind::SlaveReset:
        damage.reset = damage.refused = true;
        deaf_[address_] = later(phase.start, what.time);
        break;
    case I2cFaultKind::Clash:
        damage.second_device = true;
        damage.value &= what.value;
        break;
    case I2cFaultKind::SlowRise:
        damage.phase.clock_period = std::max(damage.phase.clock_period, nominal_) + what.time;
        break;
    case I2cFaultKind::IncompleteAddressPhase:
    case I2cFaultKind::IncompleteWriteByte:
        return;
    }
    note(index, master, phase, bit, more);
}

int I2cFaults::lose_at_bit(std::size_t index, const I2cPhase& phase, I2cDamage& damage) {
    const I2cFault& what = faults_[index].what;
    std::array<int, kBits> ones{};
    std::size_t count = 0;
    for (int bit = 0; bit < kBits; ++bit)
        if ((phase.byte >> bit & 1) != 0) ones[count++] = bit;
    const int bit = what.bit ? *what.bit : ones[carried_[index].trigger.random().below(count)];
    damage.phase.byte = given_up_at(phase.byte, bit);
    damage.lost = true;
    const Time clock = std::max(phase.clock_period, nominal_);
    damage.busy_until =
        std::max({damage.busy_until, later(phase.start + (kBits - 1 - bit) * clock, what.time),
                  phase.start + kClocksOfByte * clock});
    return bit;
}

bool I2cFaults::pull(const Fault& fault, const I2cPhase& phase, I2cDamage& damage) const {
    const Time clock = std::max(damage.phase.clock_period, nominal_);
    const Time end = phase.start + kClocksOfByte * clock;
    if (fault.low_until <= phase.start || fault.low_from >= end) return false;
    if (fault.what.kind == I2cFaultKind::Scl) {
        damage.hold += fault.low_until - std::max(fault.low_from, phase.start);
        return true;
    }
    // Bit 7 is looked at in the middle of the first clock, the acknowledge in that of the ninth.
    const auto low_in = [&](Time clocks) {
        const Time looked = phase.start + clocks * clock + clock / 2;
        return looked >= fault.low_from && looked < fault.low_until;
    };
    std::uint8_t low = 0;
    for (int bit = 0; bit < kBits; ++bit)
        if (low_in(kBits - 1 - bit)) low = static_cast<std::uint8_t>(low | 1u << bit);
    if (phase.kind == I2cPhaseKind::Read) {
        damage.low |= low;
    } else if (const unsigned taken = phase.byte & low; taken != 0) {
        int bit = kBits - 1;
        while ((taken >> bit & 1) == 0)
            --bit;
        damage.phase.byte = static_cast<std::uint8_t>(given_up_at(phase.byte, bit) & ~low);
        damage.lost = true;
        damage.busy_until = std::max({damage.busy_until, fault.low_until, end});
    } else if (low_in(kBits)) {
        damage.acknowledged = true;
    }
    return low != 0 || low_in(kBits);
}

Time I2cFaults::free_from(PortIndex master, Time now) {
    Time free = now;
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        if (faults_[i].low_from > now || faults_[i].low_until <= now) continue;
        free = std::max(free, faults_[i].low_until);
        I2cPhase wanted;
        wanted.start = now;
        pulled(i, master, wanted);
    }
    return free;
}

Time I2cFaults::next_incomplete() const {
    Time next = kNever;
    for (const Fault& fault : faults_)
        next = std::min(next, fault.next);
    return next;
}

std::optional<I2cIncomplete> I2cFaults::take_incomplete(Time now) {
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        Fault& fault = faults_[i];
        if (fault.next > now) continue;
        fault.next = carried_[i].trigger.instant(now + 1);
        if (!carried_[i].trigger.fires(now)) continue;
        const bool write = fault.what.kind == I2cFaultKind::IncompleteWriteByte;
        address_ = fault.what.where.address.value_or(0);
        const auto byte = static_cast<std::uint8_t>(address_ << 1 | (write ? 0 : kReadBit));
        reading_ = !write;
        position_ = 0;
        note(i, static_cast<PortIndex>(masters_.size()), {I2cPhaseKind::Start, byte, 0, now, nominal_, 0});
        return I2cIncomplete{byte, write};
    }
    return std::nullopt;
}

}  // namespace puckloop::cosim
