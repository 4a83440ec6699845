#include "emu/bluetooth/air_node.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "protocols/serial/uart_sampling.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::bluetooth {

using cosim::Time;

namespace {

/// No character takes less: 921600 baud.
const Time kShortestToStop = SerialOut::kBitsToStop * SerialOut::bit_period_of({10, 0, 1});

}  // namespace

AirNode::AirNode(const AirSpec& spec)
    : spec_(spec),
      network_(spec.times, spec.range, spec.seed,
               [this](Time at, std::string_view who, std::string_view what, std::string_view whom,
                      Time since) { write(at, who, what, whom, since); }) {
    check();
    for (const RobotModule& robot : spec_.modules) {
        ports_.push_back({robot.module.name, cosim::PortKind::Uart});
        modules_.push_back(std::make_unique<Module>(robot.module, network_));
    }
    for (const ComputerOptions& computer : spec_.computers) {
        ports_.push_back({computer.name, cosim::PortKind::Uart});
        computers_.push_back(std::make_unique<Computer>(computer, network_));
    }
    heard_until_.resize(ports_.size());
    places_.resize(modules_.size());
    ports_.push_back({"world", cosim::PortKind::Signals});
    if (spec_.csv.empty()) return;
    log_ = new_file(spec_.csv);
    if (log_ == nullptr) throw RunError(fmt::format("{}: cannot be written", spec_.csv));
    fmt::print(log_, "time_s,who,what,whom,seconds\n");
}

AirNode::~AirNode() {
    if (log_ != nullptr) std::fclose(log_);
}

void AirNode::check() const {
    const auto refuse = [&](const std::string& what, const char* expected) {
        throw InputError("", spec_.name, what, expected);
    };
    const auto spread = [&](const char* name, const Spread& of) {
        if (!(of.mean >= 0.05 && of.mean <= 600 && of.sd >= 0 && of.sd <= 600))
            refuse(fmt::format("bad {} time", name), "a mean of 0.05 s to 600 s, a deviation of 0 to 600 s");
    };
    if (!(spec_.range > 0 && spec_.range < 1e5)) refuse("bad range", "more than 0 m, at most 100 km");
    if (!(spec_.times.discovery >= 0.01 && spec_.times.discovery <= 3600))
        refuse("bad discovery time", "0.01 s to 1 h");
    spread("name", spec_.times.name);
    spread("link", spec_.times.link);
    spread("release", spec_.times.release);
    for (const RobotModule& robot : spec_.modules)
        if (robot.module.boot <= 0 || robot.module.processing <= 0)
            refuse("bad boot or processing time of " + robot.module.name, "more than 0 s");
}

SerialOut& AirNode::serial(std::size_t port) {
    return port < modules_.size() ? modules_[port]->serial() : computers_[port - modules_.size()]->serial();
}

const SerialOut& AirNode::serial(std::size_t port) const {
    return const_cast<AirNode&>(*this).serial(port);
}

void AirNode::advance(Time until, std::span<const cosim::Message> inbox,
                      std::vector<cosim::Message>& outbox) {
    outbox_ = &outbox;
    for (const cosim::Message& message : inbox) {
        run(message.time, true);
        receive(message);
    }
    run(until, false);
    granted_ = until;
    outbox_ = nullptr;
}

void AirNode::run(Time until, bool inclusive) {
    const auto due = [&](Time time) { return time < until || (inclusive && time == until); };
    for (;;) {
        Time byte = cosim::kNever;
        std::size_t port = 0;
        for (std::size_t p = 0; p + 1 < ports_.size(); ++p)
            if (serial(p).next() < byte) {
                byte = serial(p).next();
                port = p;
            }
        const Time event = network_.agenda().next();
        if (event <= byte && due(event)) {
            network_.step();
        } else if (due(byte)) {
            const cosim::UartFrame frame = serial(port).take();
            outbox_->push_back(
                {protocols::stop_bit_start(frame), static_cast<cosim::PortIndex>(port), frame});
        } else {
            return;
        }
    }
}

void AirNode::receive(const cosim::Message& message) {
    if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload))
        receive_frame(message.port, *frame, message.time);
    else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload))
        place(*signal, message.time);
}

/// A receiver that is faster than the sender has a character before the frame that holds it has come in.
void AirNode::receive_frame(std::size_t port, const cosim::UartFrame& frame, Time now) {
    const bool of_module = port < modules_.size();
    const SerialSettings& line =
        of_module ? modules_[port]->line() : computers_[port - modules_.size()]->line();
    const protocols::UartReceiver receiver{
        .bit_period = SerialOut::bit_period_of(line), .data_bits = 8, .parity = line.parity};
    for (const auto& character : protocols::sample_frame(frame, receiver, heard_until_[port])) {
        heard_until_[port] = character.time;
        const Time at = std::max(character.time, now);
        const auto byte = static_cast<std::uint8_t>(character.data);
        if (!of_module)
            computers_[port - modules_.size()]->byte_received(byte, at);
        else if (character.is_break)
            modules_[port]->break_received(at);
        else if (character.framing_error || character.parity_error)
            modules_[port]->framing_error();
        else
            modules_[port]->byte_received(byte, at);
    }
}

void AirNode::place(const cosim::Signal& signal, Time now) {
    for (std::size_t m = 0; m < modules_.size(); ++m) {
        const int axis = static_cast<int>(signal.id) - spec_.modules[m].pose;
        if (spec_.modules[m].pose < 0 || axis < 0 || axis > 1) continue;
        Place& place = places_[m];
        (axis == 0 ? place.x_known : place.y_known) = true;
        place.at[static_cast<std::size_t>(axis)] = signal.value;
        if (place.x_known && place.y_known) network_.place(m, place.at, now);
    }
}

Time AirNode::earliest_output(cosim::PortIndex port) const {
    if (port + 1u >= ports_.size()) return cosim::kNever;
    // A byte that begins is handed out when its stop bit begins.
    const Time next = std::min(serial(port).next(), network_.agenda().next());
    return std::max(granted_, cosim::later(next, kShortestToStop));
}

Time AirNode::lookahead(cosim::PortIndex port) const {
    if (port + 1u >= ports_.size()) return cosim::kNever;
    Time shortest = std::min({spec_.times.gather, spec_.times.latency, kShortest});
    for (const RobotModule& robot : spec_.modules)
        shortest = std::min({shortest, robot.module.processing, robot.module.boot});
    return shortest + kShortestToStop;
}

void AirNode::write(Time at, std::string_view who, std::string_view what, std::string_view whom, Time since) {
    if (log_ == nullptr) return;
    fmt::print(log_, "{:.6f},{},{},{},{:.3f}\n", cosim::to_seconds(at), who, what, whom,
               cosim::to_seconds(at - since));
}

}  // namespace puckloop::bluetooth
