#include "linuxboard/coordinator/module.h"

#include <array>

namespace puckloop::coordinator {

using namespace protocols;

namespace {

constexpr std::uint8_t kFrameId = 1;  // of all AT commands
constexpr std::size_t kAtOnce = 256;  // bytes a look

}  // namespace

XBeeCommand command_of(std::string_view letters) {
    return {letters.at(0), letters.at(1)};
}

Module::Module(control::Transport& line, Receiver receiver, FaultLog faults)
    : line_(line), receiver_(std::move(receiver)), faults_(std::move(faults)) {}

void Module::send(const XBeeMessage& message) {
    ++counters_.sent;
    line_.write(encode_xbee(encode(message), XBeeApiMode::Escaped));
}

void Module::listen(double until) {
    do
        read_once(until);
    while (line_.now() < until);
}

std::optional<XBeeAtResponse> Module::ask(std::string_view command, XBeeBytes value, double until,
                                          const std::function<bool()>& ended) {
    const XBeeCommand letters = command_of(command);
    awaited_ = &letters;
    response_.reset();
    send(XBeeAt{.id = kFrameId, .command = letters, .value = std::move(value)});
    while (!response_ && line_.now() < until && !ended())
        read_once(until);
    awaited_ = nullptr;
    return response_;
}

void Module::read_once(double until) {
    std::array<std::uint8_t, kAtOnce> bytes;
    const std::size_t count = line_.read(bytes, until);
    counters_.bytes += count;
    for (std::size_t i = 0; i < count; ++i)
        take(bytes[i]);
}

void Module::take(std::uint8_t byte) {
    const std::optional<XBeeReading> reading = reader_.take(byte);
    if (!reading) return;
    if (!reading->ok()) {
        ++counters_.faults;
        faults_(explain(*reading));
        return;
    }
    ++counters_.frames;
    const XBeeMessage message = decode_xbee(reading->data);
    if (const auto* answer = std::get_if<XBeeAtResponse>(&message);
        answer && awaited_ && answer->command == *awaited_) {
        response_ = *answer;
        return;
    }
    receiver_(message);
}

}  // namespace puckloop::coordinator
