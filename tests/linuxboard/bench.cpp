#include "tests/linuxboard/bench.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

namespace puckloop::tests {

using namespace cosim;

std::string program(const std::string& name) {
    return std::string(PUCKLOOP_TEST_PROGRAMS) + "/test_" + name;
}

linuxboard::LinuxSpec spec_for(const std::string& name, std::vector<std::string> args) {
    static int count = 0;
    linuxboard::LinuxSpec spec;
    spec.program = program(name);
    spec.args = std::move(args);
    spec.host_name = "epuck12";
    spec.log = fmt::format("/tmp/puckloop_linux_test_{}_{}.log", getpid(), count++);
    spec.watchdog_s = 20.0;
    return spec;
}

Bench::Bench(linuxboard::LinuxSpec spec, Time slice, std::unique_ptr<linuxboard::Scenery> scenery)
    : spec_(spec), log_file_{spec_.log}, node_(std::move(spec), std::move(scenery)), slice_(slice) {}

void Bench::change(Time time, std::uint16_t id, double value) {
    queue({time, linuxboard::kCameraPort, Signal{id, value}});
}

Bench::~Bench() = default;

Bench::LogFile::~LogFile() {
    unlink(path.c_str());
}

void Bench::queue(Message message) {
    const auto place = std::upper_bound(pending_.begin(), pending_.end(), message,
                                        [](const Message& a, const Message& b) { return a.time < b.time; });
    pending_.insert(place, std::move(message));
}

void Bench::send(Time start, std::uint8_t byte, double baud) {
    UartFrame frame;
    frame.start = start;
    frame.bit_period = static_cast<Time>(1e12 / baud);
    frame.data = byte;
    queue({protocols::stop_bit_start(frame), linuxboard::kUartPort, frame});
}

void Bench::send(Time start, const std::string& bytes) {
    constexpr Time kByteTime = 86'805'560;
    for (const char byte : bytes) {
        send(start, static_cast<std::uint8_t>(byte));
        start += kByteTime;
    }
}

void Bench::add_device(std::uint8_t address, std::map<std::uint8_t, std::uint8_t> registers) {
    devices_[address] = std::move(registers);
}

void Bench::answer_i2c(const I2cPhase& phase) {
    I2cPhase answer;
    answer.kind = I2cPhaseKind::Acknowledge;
    answer.ack = 1;
    switch (phase.kind) {
    case I2cPhaseKind::Start:
        address_ = static_cast<std::uint8_t>(phase.byte >> 1);
        answer.ack = devices_.contains(address_) ? 1 : 0;
        register_set_ = false;
        break;
    case I2cPhaseKind::Write:
        if (register_set_) {
            devices_[address_][register_++] = phase.byte;
        } else {
            register_ = phase.byte;
            register_set_ = true;
        }
        break;
    case I2cPhaseKind::Read:
        answer.kind = I2cPhaseKind::Data;
        answer.byte = devices_[address_][register_++];
        break;
    default:
        return;
    }
    answer.start = phase.start;
    answer.clock_period = phase.clock_period;
    queue({phase.start + 9 * phase.clock_period, linuxboard::kI2cPort, answer});
}

/// What comes in there: frames, answers on the bus, in any order; the node must be as it was afterwards.
void Bench::run_ahead_in_vain() {
    auto* const back = dynamic_cast<cosim::BoundedRewindable*>(node_.rewindable());
    if (back == nullptr) return;
    back->mark();
    const auto below = [this](Time span) {
        return static_cast<Time>(made_up_->below(static_cast<std::uint64_t>(span)));
    };
    std::vector<Message> outbox;
    Time at = now_;
    for (auto left = made_up_->below(30); left > 0; --left) {
        Message message{at + below(120 * cosim::kMicrosecond), linuxboard::kUartPort, {}};
        if (made_up_->below(3) == 0) {
            I2cPhase phase;
            phase.kind = std::array{cosim::I2cPhaseKind::Acknowledge, cosim::I2cPhaseKind::Data,
                                    cosim::I2cPhaseKind::BusLost}[made_up_->below(3)];
            phase.ack = static_cast<std::uint8_t>(made_up_->below(4) != 0);
            phase.byte = static_cast<std::uint8_t>(made_up_->below(256));
            message.port = linuxboard::kI2cPort;
            message.payload = phase;
        } else {
            const Time bit = cosim::kSecond / 115'200;
            message.payload = UartFrame{message.time - 9 * bit, bit, static_cast<std::uint16_t>(below(256))};
        }
        const Time reach = back->horizon({&message, 1});
        if (message.time < reach) {
            node_.advance(message.time + 1, {&message, 1}, outbox);
            at = message.time + 1;
        } else if (reach > at && reach < at + cosim::kSecond) {
            node_.advance(reach, {}, outbox);
            at = reach;
        }
    }
    back->rewind();
    back->settle();
}

void Bench::run(Time end, bool past_stop) {
    while (now_ < end && (past_stop || !node_.stop())) {
        if (made_up_) run_ahead_in_vain();
        const Time until = std::min(end, now_ + slice_);
        const auto split = std::find_if(pending_.begin(), pending_.end(),
                                        [until](const Message& message) { return message.time >= until; });
        const std::vector<Message> inbox(pending_.begin(), split);
        pending_.erase(pending_.begin(), split);
        std::vector<Message> outbox;
        const Time uart_eot = node_.earliest_output(linuxboard::kUartPort);
        const Time i2c_eot = node_.earliest_output(linuxboard::kI2cPort);
        node_.advance(until, inbox, outbox);
        now_ = until;
        const Time first_in = inbox.empty() ? kNever : inbox.front().time;
        for (const Message& message : outbox) {
            const Time earliest = message.port == linuxboard::kUartPort ? uart_eot : i2c_eot;
            if (message.time < std::min(earliest, first_in))
                throw std::logic_error(
                    fmt::format("before the earliest output time: {} before {}", message.time, earliest));
            if (const auto* frame = std::get_if<UartFrame>(&message.payload)) {
                trace_ += fmt::format("{} uart {} {:02x}\n", message.time, frame->start, frame->data);
                sent_ += static_cast<char>(frame->data);
                if (on_byte) on_byte(message.time, static_cast<std::uint8_t>(frame->data));
            } else if (const auto* phase = std::get_if<I2cPhase>(&message.payload)) {
                trace_ += fmt::format("{} i2c {} {:02x} {}\n", message.time, static_cast<int>(phase->kind),
                                      phase->byte, phase->ack);
                answer_i2c(*phase);
            }
        }
    }
}

std::string Bench::log() const {
    std::ifstream file(spec_.log);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

}  // namespace puckloop::tests
