#include "reproductions/rab/i2c_host.h"

#include <algorithm>
#include <cmath>

namespace puckloop::tools {

using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {
constexpr Time kClocksOfByte = 9;
constexpr Time kClocksOfStop = 2;  // and the gap to the next START
constexpr std::uint8_t kReadBit = 1;
}  // namespace

I2cHost::I2cHost(std::uint8_t address, double clock_hertz)
    : address_byte_(static_cast<std::uint8_t>(address << 1)),
      clock_(static_cast<Time>(std::llround(static_cast<double>(cosim::kSecond) / clock_hertz))) {}

void I2cHost::write(Time earliest, std::vector<std::uint8_t> bytes) {
    Transfer transfer{earliest, {{I2cPhaseKind::Start, address_byte_}}, {}};
    for (const std::uint8_t byte : bytes)
        transfer.steps.push_back({I2cPhaseKind::Write, byte});
    transfer.steps.push_back({I2cPhaseKind::Stop, 0});
    queue_.push_back(std::move(transfer));
}

void I2cHost::read(Time earliest, std::uint8_t register_number, Done done) {
    queue_.push_back({earliest,
                      {{I2cPhaseKind::Start, address_byte_},
                       {I2cPhaseKind::Write, register_number},
                       {I2cPhaseKind::Start, static_cast<std::uint8_t>(address_byte_ | kReadBit)},
                       {I2cPhaseKind::Read, 0},
                       {I2cPhaseKind::Stop, 0}},
                      std::move(done)});
}

Time I2cHost::due() const {
    if (open_ || queue_.empty()) return cosim::kNever;
    return step_ == 0 ? std::max(free_, queue_.front().earliest) : free_;
}

I2cPhase I2cHost::next() {
    const Time now = due();
    const Step step = queue_.front().steps[step_];
    const I2cPhase phase{step.kind, step.byte, 0, now, clock_, 0};
    if (step.kind != I2cPhaseKind::Stop) {
        open_ = phase;
        return phase;
    }
    free_ = now + kClocksOfStop * clock_;
    finish(byte_, now);
    return phase;
}

void I2cHost::finish(std::optional<std::uint8_t> byte, Time now) {
    const Done done = std::move(queue_.front().done);
    queue_.pop_front();
    step_ = 0;
    byte_.reset();
    if (done) done(byte, now);
}

void I2cHost::answered(const I2cPhase& answer, Time now) {
    if (!open_) return;
    const I2cPhase phase = *open_;
    open_.reset();
    free_ = std::max(phase.start + kClocksOfByte * clock_, now + clock_);
    ++step_;
    if (phase.kind == I2cPhaseKind::Read) {
        byte_ = answer.byte;
    } else if (answer.ack == 0) {
        ++refused_;
        step_ = queue_.front().steps.size() - 1;  // STOP
    }
}

}  // namespace puckloop::tools
