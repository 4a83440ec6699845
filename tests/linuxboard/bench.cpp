#include "tests/linuxboard/bench.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
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
    : spec_(spec), node_(std::move(spec), std::move(scenery)), slice_(slice) {}

void Bench::change(Time time, std::uint16_t id, double value) {
    queue({time, linuxboard::kCameraPort, Signal{id, value}});
}

Bench::~Bench() {
    unlink(spec_.log.c_str());
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

void Bench::run(Time end, bool past_stop) {
    while (now_ < end && (past_stop || !node_.stop())) {
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
