#include "emu/rab_board/i2c_watch.h"

#include "base/logs/node_log.h"
#include "protocols/infrared/rab_frame.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::rab {

namespace {

using cosim::I2cPhaseKind;
using cosim::Time;

constexpr std::uint8_t kReadBit = 1;

// Registers by number, reading and writing being different things (fact sheet 2.1).
constexpr int kPoll = 0, kSendAll = 14, kSendArmed = 15, kPayloadSize = 21;
constexpr int kLastWritable = 21;
constexpr int kLastMessage = 11, kFirstPeak = 20, kLastPeak = 46;

bool writable(int number) {
    return number <= kLastWritable;
}
bool readable(int number) {
    return number <= kLastMessage || (number >= kFirstPeak && number <= kLastPeak);
}

}  // namespace

void I2cWatch::phase(const cosim::I2cPhase& phase, Time /*now*/) {
    open_ = phase;
    if (phase.kind == I2cPhaseKind::Start) awaiting_register_ = (phase.byte & kReadBit) == 0;
}

void I2cWatch::answer(const cosim::I2cPhase& answer, Time now) {
    stretched(answer.stretch, now);
    if (answer.kind == I2cPhaseKind::Data) {
        ++counters_.bytes_read;
        read(answer.byte, now);
        return;
    }
    if (open_.kind == I2cPhaseKind::Read) return;  // what is on SDA behind a byte that was read
    const bool start = open_.kind == I2cPhaseKind::Start;
    if (start && answer.ack == 0 && open_.byte >> 1 != kAddress) return;
    if (start) ++counters_.transfers;
    if (answer.ack == 0) {
        ++counters_.not_acknowledged;
        if (is_milestone(counters_.not_acknowledged))
            log_line_(now, fmt::format("i2c: {} not acknowledged, {} so far", start ? "address" : "byte",
                                       counters_.not_acknowledged));
        return;
    }
    if (open_.kind != I2cPhaseKind::Write) return;
    ++counters_.bytes_written;
    if (awaiting_register_) {
        register_ = open_.byte;
        read_index_ = 0;
        awaiting_register_ = false;
    } else {
        written(open_.byte, now);
    }
}

std::string I2cWatch::place() const {
    return register_ ? fmt::format("register {}", *register_) : "a register never named";
}

void I2cWatch::stretched(Time by, Time now) {
    counters_.stretched += by;
    counters_.longest_stretch = std::max(counters_.longest_stretch, by);
    if (by <= kLongStretch) return;
    ++counters_.long_stretches;
    if (!is_milestone(counters_.long_stretches)) return;
    std::string what = "at " + place();
    if (open_.kind == I2cPhaseKind::Write) what = fmt::format("after 0x{:02x} for {}", open_.byte, place());
    log_line_(now, fmt::format("i2c: SCL held for {:.3f} ms {}, {} so far", cosim::to_seconds(by) * 1e3, what,
                               counters_.long_stretches));
}

void I2cWatch::count(std::uint64_t& counter, Time now, const std::string& text) {
    if (!is_milestone(++counter)) return;
    log_line_(now, counter == 1 ? text : fmt::format("{}, {} so far", text, counter));
}

void I2cWatch::written(std::uint8_t value, Time now) {
    const std::uint8_t number = register_.value_or(0);
    if (!writable(number)) {
        const bool known = readable(number);
        ++(known ? counters_.read_only_writes : counters_.unknown_writes);
        count((known ? read_only_writes_ : unknown_writes_)[number], now,
              fmt::format("i2c: write of 0x{:02x} to register {}, {}", value, number,
                          known ? "which is read only" : "which does not exist"));
        return;
    }
    if (number == kSendAll || number == kSendArmed) ++counters_.sends;
    if (number != kPayloadSize) return;
    if (!protocols::is_rab_size(value)) {
        count(counters_.bad_sizes, now,
              fmt::format("i2c: payload size {} asked for, which is none of {}", value,
                          protocols::kRabSizesText));
    } else if (is_milestone(++sizes_)) {
        log_line_(now, fmt::format("i2c: payload size {} bits asked for{}", value,
                                   sizes_ > 1 ? fmt::format(", {} so far", sizes_) : ""));
    }
}

void I2cWatch::read(std::uint8_t value, Time now) {
    const int number = register_.value_or(0);
    const int index = read_index_++;
    if (number == kPoll && index == 0) ++(value == 1 ? counters_.messages : counters_.empty_polls);
    // Further bytes of a read come from the registers that follow; the first decides.
    if (index > 0 || readable(number)) return;
    ++counters_.unknown_reads;
    count(unknown_reads_[static_cast<std::size_t>(number)], now,
          fmt::format("i2c: read of register {}, {}: 0x{:02x}", number,
                      writable(number) ? "which is write only" : "which does not exist", value));
}

}  // namespace puckloop::rab
