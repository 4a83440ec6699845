#include "emu/bluetooth/computer.h"

#include <utility>

namespace puckloop::bluetooth {

using cosim::Time;

namespace {

constexpr Time kPatience = 2 * cosim::kSecond;
constexpr std::uint8_t kPort = 1;

}  // namespace

Computer::Computer(const ComputerOptions& options, Network& network)
    : options_(options), network_(network), number_(network.add(*this)) {
    serial_.set(options_.serial);
    again(options_.connect);
}

void Computer::again(Time at) {
    network_.agenda().add(at, {EventKind::Dial, number_, number_});
}

void Computer::happen(const Event& event, Time now) {
    if (event.kind == EventKind::Dial) network_.connect(number_, options_.robot, kPort, kPort, now);
    if (event.kind != EventKind::Flush) return;
    flush_waits_ = false;
    flush(now);
}

void Computer::byte_received(std::uint8_t byte, Time now) {
    gathered_.push_back(byte);
    if (link_ == 0 || flush_waits_) return;
    flush_waits_ = true;
    network_.agenda().add(now + network_.times().gather, {EventKind::Flush, number_, number_});
}

void Computer::flush(Time now) {
    if (link_ != 0 && !gathered_.empty()) network_.send(number_, link_, std::exchange(gathered_, {}), now);
}

void Computer::linked(const Address&, std::uint8_t, std::uint8_t, std::uint8_t, LinkId link, Time now) {
    link_ = link;
    if (link == 0)
        again(now + kPatience);
    else
        flush(now);
}

void Computer::received(LinkId, const Bytes& bytes, Time now) {
    serial_.put(bytes, now);
}

void Computer::released(LinkId, std::uint8_t, Time now) {
    link_ = 0;
    again(now + kPatience);
}

}  // namespace puckloop::bluetooth
