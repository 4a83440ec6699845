#include "bench/i2c_script_master.h"

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

/// The steps of the present line.
void I2cScriptMaster::plan() {
    const I2cScriptLine& line = script_[line_];
    const auto address = static_cast<std::uint8_t>(line.address << 1);
    steps_.clear();
    step_ = 0;
    reading_ = false;
    if (!line.read || line.register_number) steps_.push_back({I2cPhaseKind::Start, address});
    if (line.read) {
        if (line.register_number) {
            steps_.push_back({I2cPhaseKind::Write, *line.register_number});
            if (!repeated_start_) steps_.push_back({I2cPhaseKind::Stop});
        }
        steps_.push_back({I2cPhaseKind::Start, static_cast<std::uint8_t>(address | kReadBit)});
        for (int i = 1; i <= line.count; ++i)
            steps_.push_back({I2cPhaseKind::Read, 0, static_cast<std::uint8_t>(i < line.count ? 1 : 0)});
    } else {
        for (const std::uint8_t byte : line.bytes)
            steps_.push_back({I2cPhaseKind::Write, byte});
    }
    steps_.push_back({I2cPhaseKind::Stop});
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
    I2cPhase phase{step.kind, step.byte, step.ack, next_, clock_, 0};
    if (step.kind == I2cPhaseKind::Start) ++report_.starts;
    if (step.kind != I2cPhaseKind::Stop) open_ = phase;  // before: the answer may come at once
    target_.i2c_slave_phase(phase);
    if (step.kind != I2cPhaseKind::Stop) return;
    if (logs_ != nullptr) logs_->i2c(kI2cScriptUnit, phase);
    report_.last_stop = phase.start + clock_;
    next_ = phase.start + 2 * clock_;
    if (++step_ == steps_.size()) next_line();
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
    I2cPhase phase = *open_;
    open_.reset();
    phase.stretch = answer.stretch;
    report_.stretched += answer.stretch;
    report_.longest_stretch = std::max(report_.longest_stretch, answer.stretch);
    next_ = std::max(phase.start + kClocksOfByte * clock_, now + clock_);
    ++step_;
    if (phase.kind == I2cPhaseKind::Read) {
        phase.byte = answer.byte;
        ++report_.bytes_read;
        if (!reading_ && report_.reads.size() < kMostReads) {
            const I2cScriptLine& line = script_[line_];
            report_.reads.push_back({line.time, line.address, line.register_number, {}});
            reading_ = true;
        }
        if (reading_) report_.reads.back().bytes.push_back(answer.byte);
    } else {
        phase.ack = answer.ack;
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
    step_ = steps_.size() - 1;
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
