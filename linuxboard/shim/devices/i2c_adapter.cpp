#include "linuxboard/shim/devices/i2c_adapter.h"

#include "cosim/i2c/i2c_shared.h"

#include <algorithm>
#include <cerrno>
#include <utility>

namespace puckloop::linuxboard {

using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::kNever;
using cosim::Time;

namespace {
constexpr std::uint32_t kNobody = UINT32_MAX;
constexpr std::size_t kBlockMaximum = 32;  // SMBus block length
constexpr std::uint8_t kReadBit = 1;

/// 11110, the upper two bits, "write".
std::uint8_t first_of_ten(const I2cMessage& message) {
    return static_cast<std::uint8_t>(0xF0 | (message.address >> 7 & 6));
}
}  // namespace

void I2cAdapter::submit(I2cTransfer transfer, Time now) {
    queue_.push_back(std::move(transfer));
    if (step_ == Step::Idle) begin_next(now);
}

void I2cAdapter::abandon(std::uint32_t owner) {
    for (I2cTransfer& transfer : queue_) {
        if (transfer.owner == owner) transfer.owner = kNobody;
    }
    if (result_.owner == owner) result_.owner = kNobody;
}

void I2cAdapter::begin_next(Time now) {
    if (queue_.empty()) {
        step_ = Step::Idle;
        next_ = kNever;
        return;
    }
    result_ = {};
    result_.owner = queue_.front().owner;
    message_ = 0;
    shared_ = stopping_ = false;
    step_ = Step::Start;
    next_ = std::max(now, bus_free_) + hold_;
    if (queue_.front().messages.empty()) step_ = Step::Finish;
}

I2cPhase I2cAdapter::phase(I2cPhaseKind kind, std::uint8_t byte) const {
    I2cPhase out;
    out.kind = kind;
    out.byte = byte;
    out.start = next_;
    out.clock_period = period_;
    return out;
}

void I2cAdapter::advance(Time now, std::vector<I2cPhase>& begun) {
    while (next_ <= now) {
        const I2cTransfer& transfer = queue_.front();
        if (step_ == Step::Start) {
            const I2cMessage& message = transfer.messages[message_];
            timeout_at_ = cosim::later(next_, transfer.timeout);
            byte_ = 0;
            addressed_ = false;
            address_bytes_ = 0;
            length_ = message.read ? message.length : message.data.size();
            const auto seven = static_cast<std::uint8_t>(message.address << 1 | (message.read ? 1 : 0));
            begun.push_back(phase(I2cPhaseKind::Start, message.ten_bits ? first_of_ten(message) : seven));
            step_ = Step::Waiting;
            next_ = timeout_at_;
        } else if (step_ == Step::SecondAddress || step_ == Step::ReadAgain) {
            const I2cMessage& message = transfer.messages[message_];
            if (step_ == Step::SecondAddress)
                begun.push_back(phase(I2cPhaseKind::Write, static_cast<std::uint8_t>(message.address)));
            else
                begun.push_back(
                    phase(I2cPhaseKind::Start, static_cast<std::uint8_t>(first_of_ten(message) | kReadBit)));
            step_ = Step::Waiting;
            next_ = timeout_at_;
        } else if (step_ == Step::Byte) {
            const I2cMessage& message = transfer.messages[message_];
            if (message.read) {
                I2cPhase read = phase(I2cPhaseKind::Read);
                read.ack = byte_ + 1 < length_ || (message.counted && byte_ == 0) ? 1 : 0;
                begun.push_back(read);
            } else {
                begun.push_back(phase(I2cPhaseKind::Write, static_cast<std::uint8_t>(message.data[byte_])));
            }
            step_ = Step::Waiting;
            next_ = timeout_at_;
        } else if (step_ == Step::Stop) {
            begun.push_back(phase(I2cPhaseKind::Stop));
            stopping_ = shared_;
            step_ = stopping_ ? Step::Waiting : Step::Finish;
            next_ = stopping_ ? cosim::later(next_, transfer.timeout) : next_ + period_;
        } else if (step_ == Step::Finish) {
            bus_free_ = next_;
            result_.time = next_;
            if (result_.error != 0) result_.messages = 0;
            ++transfers_;
            failures_ += result_.error != 0 ? 1 : 0;
            const Time done = next_;
            results_.push_back(std::move(result_));
            queue_.pop_front();
            begin_next(done);
        } else {  // the message took too long: the driver resets its controller, which lets the bus go
            shared_ = stopping_ = false;
            fail(ETIMEDOUT, next_, true);
        }
    }
}

void I2cAdapter::fail(int error, Time now, bool owns_bus) {
    result_.error = error;
    result_.data.clear();
    step_ = owns_bus ? Step::Stop : Step::Finish;
    next_ = now;
}

/// Whether more of a ten-bit address is to follow.
bool I2cAdapter::goes_on_addressing(const I2cMessage& message, Time now) {
    if (addressed_ || !message.ten_bits || address_bytes_ == (message.read ? 2 : 1)) return false;
    step_ = address_bytes_++ == 0 ? Step::SecondAddress : Step::ReadAgain;
    next_ = now;
    return true;
}

void I2cAdapter::after_byte(Time now) {
    next_ = now;
    if (byte_ < length_) {
        step_ = Step::Byte;
        return;
    }
    ++result_.messages;
    ++message_;
    step_ = message_ < queue_.front().messages.size() ? Step::Start : Step::Stop;
}

void I2cAdapter::deliver(const I2cPhase& answer, Time now) {
    if (step_ != Step::Waiting) return;
    if (answer.kind == cosim::kSharedNotice) {
        shared_ = true;
        return;
    }
    if (stopping_ && answer.kind == I2cPhaseKind::Acknowledge) {
        step_ = Step::Finish;
        next_ = now;
        return;
    }
    if (answer.kind == I2cPhaseKind::BusLost) return fail(EAGAIN, now, false);
    const I2cMessage& message = queue_.front().messages[message_];
    switch (answer.kind) {
    case I2cPhaseKind::Acknowledge:
        if (answer.ack == 0) {
            fail(nack_error_, now, true);
        } else if (!goes_on_addressing(message, now)) {
            if (addressed_) ++byte_;
            addressed_ = true;
            after_byte(now);
        }
        break;
    case I2cPhaseKind::Data:
        result_.data += static_cast<char>(answer.byte);
        if (message.counted && byte_ == 0) {
            if (answer.byte == 0 || answer.byte > kBlockMaximum) {
                fail(EPROTO, now, true);
                return;
            }
            length_ += answer.byte;
        }
        ++byte_;
        after_byte(now);
        break;
    default:
        break;
    }
}

Time I2cAdapter::next_event() const {
    return next_;
}

Time I2cAdapter::next_completion() const {
    switch (step_) {
    case Step::Stop:
        return cosim::later(next_, period_);
    case Step::Start:  // it then waits for an answer
        return cosim::later(next_, queue_.front().timeout);
    case Step::SecondAddress:
    case Step::ReadAgain:
    case Step::Byte:
        return timeout_at_;
    case Step::Idle:
    case Step::Finish:
    case Step::Waiting:
        break;
    }
    return next_;
}

std::vector<I2cResult> I2cAdapter::take_results() {
    return std::exchange(results_, {});
}

}  // namespace puckloop::linuxboard
