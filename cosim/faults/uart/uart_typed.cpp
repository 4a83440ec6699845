// Bytes that somebody types into a line, as a terminal that is plugged in beside the sender would.
//
// Deviation: real transmitters on one wire fight over its level. Here what the sender sends meanwhile is on
// the line as well, and a receiver takes what begins while it is free.

#include "cosim/faults/frame_fault.h"
#include "cosim/faults/spec/typed_bytes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::cosim {

namespace {

/// 8N1 at the line's nominal rate, or at `baud`, without a pause.
class Typed : public FrameFault {
  public:
    using FrameFault::FrameFault;

    std::vector<Delivery> preset() override {
        const std::vector<std::uint8_t> bytes = typed_bytes(spec().parameters.text("data"));
        std::vector<Delivery> typed;
        Time free = 0;
        for (Time at = trigger().instant(0); at != kNever; at = trigger().instant(at + 1)) {
            if (!trigger().fires(at)) {
                if (trigger().spent()) break;
                continue;
            }
            for (const std::uint8_t byte : bytes) {
                UartFrame frame;
                frame.start = std::max(at, free);
                frame.bit_period = period();
                frame.data = byte;
                free = frame.start + frame_time(frame);
                typed.push_back(own(frame, FaultKind::Insert, text_of(Payload(frame))));
            }
        }
        return typed;
    }

  protected:
    bool can_suffer(const Payload&) const override { return false; }
    void harm(std::size_t, std::vector<Delivery>&) override {}

  private:
    Time period() const {
        const double baud = spec().parameters.number("baud");
        return baud > 0 ? std::max<Time>(1, std::llround(static_cast<double>(kSecond) / baud)) : bit_time();
    }
};

int hex_digit_of(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

}  // namespace

std::vector<std::uint8_t> typed_bytes(std::string_view hexadecimal) {
    std::vector<std::uint8_t> bytes;
    int high = -1;
    for (const char c : hexadecimal) {
        if (c == ' ' && high < 0) continue;
        const int digit = hex_digit_of(c);
        if (digit < 0) return {};
        if (high >= 0) bytes.push_back(static_cast<std::uint8_t>(high * 16 + digit));
        high = high < 0 ? digit : -1;
    }
    if (high >= 0) bytes.clear();
    return bytes;
}

std::unique_ptr<LinkFault> make_typed_fault(const FaultPlan& plan) {
    // Its mark is that of `insert`: a byte that nobody sent.
    if (plan.kind.name != kTypedKind) return nullptr;
    return std::make_unique<Typed>(plan);
}

}  // namespace puckloop::cosim
