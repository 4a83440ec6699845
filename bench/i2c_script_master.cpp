#include "bench/i2c_script_master.h"

#include "cosim/i2c/i2c_shared.h"

#include <algorithm>
#include <cmath>

namespace puckloop::exec {

using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {
constexpr Time kClocksOfByte = 9;
constexpr std::size_t kMostReads = 1000;
constexpr std::uint8_t kReadBit = 1;
constexpr std::uint8_t kTenBits = 0xF0;
}  // namespace

I2cScriptMaster::I2cScriptMaster(std::vector<I2cScriptLine> script, const I2cMasterOptions& options,
                                 Target& target, Logs* logs)
    : script_(std::move(script)),
      clock_(static_cast<Time>(std::llround(static_cast<double>(cosim::kSecond) / options.clock_hertz))),
      repeated_start_(options.repeated_start),
      target_(target),
      logs_(logs) {
    report_.lines = script_.size();
    if (script_.empty()) return;
    next_ = script_.front().time;
    plan();
}

/// The steps of the present line. Of a ten-bit address the first byte is 11110, two bits, R/W; it is read by
/// a repeated START with the first byte again (UM10204, 3.1.11).
void I2cScriptMaster::plan() {
    const I2cScriptLine& line = script_[line_];
    steps_.clear();
    step_ = 0;
    reading_ = false;
    raw_ = !line.raw.empty();
    if (raw_) return plan_raw(line.raw);
    const auto seven = static_cast<std::uint8_t>(line.address << 1);
    const auto first_of_ten = static_cast<std::uint8_t>(kTenBits | (line.address >> 7 & 6));
    const std::uint8_t address = line.ten_bits ? first_of_ten : seven;
    const auto to_write = [&] {
        steps_.push_back({I2cPhaseKind::Start, address});
        if (line.ten_bits) steps_.push_back({I2cPhaseKind::Write, static_cast<std::uint8_t>(line.address)});
    };
    if (!line.read || line.register_number) to_write();
    if (line.read) {
        if (line.register_number) {
            steps_.push_back({I2cPhaseKind::Write, *line.register_number});
            if (!repeated_start_) steps_.push_back({I2cPhaseKind::Stop});
        }
        if (line.ten_bits && (!line.register_number || !repeated_start_)) to_write();
        steps_.push_back({I2cPhaseKind::Start, static_cast<std::uint8_t>(address | kReadBit)});
        for (int i = 1; i <= line.count; ++i)
            steps_.push_back({I2cPhaseKind::Read, 0, static_cast<std::uint8_t>(i < line.count ? 1 : 0)});
    } else {
        for (const std::uint8_t byte : line.bytes)
            steps_.push_back({I2cPhaseKind::Write, byte});
    }
    steps_.push_back({I2cPhaseKind::Stop});
}

void I2cScriptMaster::plan_raw(const std::vector<I2cRawStep>& raw) {
    constexpr I2cPhaseKind kKinds[] = {I2cPhaseKind::Start, I2cPhaseKind::Write, I2cPhaseKind::Read,
                                       I2cPhaseKind::Stop};
    for (const I2cRawStep& step : raw)
        steps_.push_back({kKinds[static_cast<std::size_t>(step.kind)], step.byte,
                          static_cast<std::uint8_t>(step.acknowledge ? 1 : 0), step.clocks});
}

Time I2cScriptMaster::due() const {
    return open_ ? cosim::kNever : next_;
}

Time I2cScriptMaster::limit() const {
    if (!open_) return next_;
    // An answer that comes at t lets the next phase begin one clock later.
    const Time now = target_.now();
    const Time answer = target_.earliest_i2c_answer();
    return (answer == cosim::kNever ? now : std::max(answer, now)) + clock_;
}

void I2cScriptMaster::begin() {
    const Step& step = steps_[step_];
    if (sends_ && (step.kind == I2cPhaseKind::Stop || step.kind == I2cPhaseKind::Start))
        return ask_first_bit();
    sends_ = false;
    I2cPhase phase{step.kind, step.byte, step.ack, next_, clock_, 0};
    if (step.kind == I2cPhaseKind::Start) {
        ++report_.starts;
        addressed_ = step.byte >> 1;
        if (raw_) reading_ = false;
    }
    const bool broken_off = step.clocks < kClocksOfByte;
    // Before: the answer may come at once. Nobody waits for that of a byte that is broken off.
    if (step.kind != I2cPhaseKind::Stop && !broken_off) open_ = phase;
    target_.i2c_slave_phase(phase);
    if (broken_off) {
        next_ += step.clocks * clock_;
        ++step_;
        return;
    }
    if (step.kind != I2cPhaseKind::Stop) return;
    if (logs_ != nullptr) logs_->i2c(kI2cScriptUnit, phase);
    report_.last_stop = phase.start + clock_;
    next_ = phase.start + 2 * clock_;
    if (++step_ == steps_.size()) next_line();
}

void I2cScriptMaster::ask_first_bit() {
    open_ = I2cPhase{I2cPhaseKind::Acknowledge, 0, cosim::kNoByteFollows, next_, clock_, 0};
    target_.i2c_slave_phase(*open_);
}

/// Of the byte that the slave has to send.
void I2cScriptMaster::first_bit_known(bool low, Time now) {
    open_.reset();
    sends_ = false;
    next_ = now + clock_;
    Step nine_clocks;
    nine_clocks.kind = I2cPhaseKind::Read;
    nine_clocks.frees = true;
    if (low) steps_.insert(steps_.begin() + static_cast<std::ptrdiff_t>(step_), nine_clocks);
}

void I2cScriptMaster::next_line() {
    ++report_.played;
    const Time free = next_;
    next_ = cosim::kNever;
    if (++line_ == script_.size()) return;
    next_ = std::max(free, script_[line_].time);
    plan();
}

void I2cScriptMaster::answered(const I2cPhase& answer, Time now) {
    if (!open_) return;  // given up
    if (open_->kind == I2cPhaseKind::Acknowledge) return first_bit_known(answer.ack != 0, now);
    I2cPhase phase = *open_;
    open_.reset();
    const bool reads = phase.kind == I2cPhaseKind::Start && (phase.byte & kReadBit) != 0;
    sends_ = reads ? answer.ack != 0 : phase.kind == I2cPhaseKind::Read && phase.ack != 0;
    const bool frees = steps_[step_].frees;
    phase.stretch = answer.stretch;
    report_.stretched += answer.stretch;
    report_.longest_stretch = std::max(report_.longest_stretch, answer.stretch);
    next_ = std::max(phase.start + kClocksOfByte * clock_, now + clock_);
    ++step_;
    if (phase.kind == I2cPhaseKind::Read) {
        phase.byte = answer.byte;
        report_.bytes_read += frees ? 0 : 1;
        if (!frees && !reading_ && report_.reads.size() < kMostReads) {
            const I2cScriptLine& line = script_[line_];
            report_.reads.push_back({line.time, raw_ ? addressed_ : line.address, line.register_number, {}});
            reading_ = true;
        }
        if (reading_ && !frees) report_.reads.back().bytes.push_back(answer.byte);
    } else {
        phase.ack = answer.ack;
        if (phase.kind == I2cPhaseKind::Write)  // a slave that sends pulls SDA low
            phase.byte = static_cast<std::uint8_t>(phase.byte & answer.byte);
        if (phase.ack == 0)
            refused(phase);
        else if (phase.kind == I2cPhaseKind::Write)
            ++report_.bytes_written;
    }
    if (steps_[step_].kind == I2cPhaseKind::Start) next_ += clock_;  // a repeated one
    if (logs_ != nullptr) logs_->i2c(kI2cScriptUnit, phase);
}

void I2cScriptMaster::refused(const I2cPhase& phase) {
    ++(phase.kind == I2cPhaseKind::Start ? report_.addresses_refused : report_.bytes_refused);
    if (report_.first_refused == 0) report_.first_refused = script_[line_].line;
    if (!raw_) step_ = steps_.size() - 1;
}

void I2cScriptMaster::poll(Time now) {
    if (!open_ || now - open_->start < kStuckAfter) return;
    I2cPhase phase = *open_;
    open_.reset();
    next_ = cosim::kNever;
    report_.stuck_since = phase.start;
    report_.stuck_line = script_[line_].line;
    phase.kind = I2cPhaseKind::BusLost;
    phase.stretch = now - phase.start;
    if (logs_ != nullptr) logs_->i2c(kI2cScriptUnit, phase);
}

}  // namespace puckloop::exec
