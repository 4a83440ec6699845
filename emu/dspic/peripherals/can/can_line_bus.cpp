// A CAN module and the bus that its board wires it to: what it offers, and what it makes of the bus's news.

#include "emu/dspic/peripherals/can/can_line.h"
#include "emu/dspic/peripherals/can/can_registers.h"

#include <algorithm>

namespace puckloop::dspic {

using namespace can;
using cosim::CanKind, cosim::CanMessage;

void CanLine::tell_bus(CanMessage message, Cycle at) {
    message.start = clock_.time_of(at);
    pins_.can_to_bus(place_.unit, message, at);
}

/// As the mode has it.
void CanLine::take_role(Cycle at) {
    if (!wired_) return;
    const Mode mode = this->mode();
    Role role = Role::Off;
    if (state_.held || mode == Mode::Disable)
        role = Role::Watches;
    else if (mode == Mode::Normal)
        role = Role::Joined;
    else if (mode == Mode::ListenOnly || mode == Mode::ListenAll)
        role = Role::Listens;
    if (role == state_.role) return;
    state_.role = role;
    state_.sending = kNobody;
    state_.withdrawn = false;
    CanMessage message = join();
    if (role == Role::Watches) message.kind = CanKind::Watch;
    if (role == Role::Listens) message.flags = cosim::kCanListens;
    tell_bus(role == Role::Off ? CanMessage{} : message, at);
}

/// Bit timing as the registers have it, and the counters.
CanMessage CanLine::join() const {
    constexpr cosim::Time kLongestBit = 0xFFFFFFFF;
    const Quanta quanta = bit_quanta();
    CanMessage message;
    message.kind = CanKind::Join;
    const cosim::Time bit = (clock_.time_of(around_.now + bit_quarters()) - clock_.time_of(around_.now)) / 4;
    message.bit_time = static_cast<std::uint32_t>(std::min(bit, kLongestBit));
    const unsigned jump = std::min(kCFG1["SJW"].of(reg(place_.cfg1)) + 1, quanta.behind_sample);
    message.data = {static_cast<std::uint8_t>(quanta.all),
                    static_cast<std::uint8_t>(quanta.all - quanta.behind_sample),
                    static_cast<std::uint8_t>(jump)};
    message.transmit_errors = state_.errors;
    message.receive_errors = static_cast<std::uint8_t>(reg(place_.ec) & 0xFF);
    return message;
}

/// The best buffer takes the place of one that was offered before; the bus knows which of them it has begun.
void CanLine::offer(Cycle at) {
    if (state_.role != Role::Joined || state_.withdrawn || state_.mode_due != kNoCycle) return;
    const int best = best_buffer();
    if (best < 0 || best == state_.sending) return;
    state_.sending = static_cast<std::uint8_t>(best);
    state_.frame = frame_of(best, at);
    CanMessage message;
    message.kind = CanKind::Offer;
    message.tag = state_.sending;
    message.id = state_.frame.id;
    message.length = state_.frame.length;
    message.data = state_.frame.data;
    message.flags = static_cast<std::uint8_t>((state_.frame.extended ? cosim::kCanExtended : 0) |
                                              (state_.frame.remote ? cosim::kCanRemote : 0));
    tell_bus(message, at);
}

void CanLine::withdraw(Cycle at) {
    if (state_.withdrawn) return;
    state_.withdrawn = true;
    CanMessage message;
    message.kind = CanKind::Withdraw;
    message.tag = state_.sending;
    tell_bus(message, at);
}

/// The bus will not send it: the program gave it up, or wants another mode and has it sent later.
void CanLine::given_up(int buffer) {
    if (state_.aborting >> buffer & 1) change_control(buffer, kTxReq, kTxAbt);
    if (state_.sending == buffer) state_.sending = kNobody;
}

void CanLine::news(const CanMessage& message, Cycle at) {
    if (message.kind == CanKind::Wake) {
        if (state_.role == Role::Watches) set_flags(kWakIf, at);
        return;
    }
    const int buffer = message.tag;
    const bool listens = state_.role == Role::Listens;
    if ((state_.role != Role::Joined && !listens) || buffer >= place_.transmitters) return;
    if (!listens) count_errors(message.transmit_errors, message.receive_errors, at);
    if (message.flags & cosim::kCanLost) change_control(buffer, 0, kTxLarb);
    if (message.flags & cosim::kCanGone) given_up(buffer);
    switch (message.kind) {
    case CanKind::Sent:
        state_.aborting &= static_cast<std::uint8_t>(~(1u << buffer));
        if (state_.sending == buffer) state_.sending = kNobody;
        change_control(buffer, kTxErr | kTxReq, 0);
        was_sent(buffer, at);
        break;
    case CanKind::Received:
        deliver({message.id, (message.flags & cosim::kCanExtended) != 0,
                 (message.flags & cosim::kCanRemote) != 0, message.length, message.data},
                at);
        break;
    case CanKind::Error:
        if (message.flags & cosim::kCanSender)
            change_control(buffer, 0, kTxErr);
        else
            set_flags(kIvrIf, at);
        break;
    case CanKind::Withdrawn:
        given_up(buffer);
        break;
    default:
        break;
    }
    if (state_.sending == kNobody) {
        state_.withdrawn = false;
        state_.aborting = 0;
        if (state_.mode_due == kNoCycle) request_mode(at);
    }
    look_for_frame(at);
    plan();
}

}  // namespace puckloop::dspic
