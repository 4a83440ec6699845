#include "bench/uart_line.h"

#include "protocols/serial/uart_sampling.h"

#include <algorithm>
#include <cmath>

namespace puckloop::exec {

namespace {
constexpr int kBitsToStop = 9;    // start and eight data bits
constexpr int kBitsOfFrame = 10;  // with the stop bit
}  // namespace

UartLine::UartLine(int unit, double baud, Target& target, Logs* logs)
    : unit_(unit),
      bit_period_(static_cast<cosim::Time>(std::llround(1e12 / baud))),
      target_(target),
      logs_(logs) {}

cosim::Time UartLine::start_of_next() const {
    const cosim::Time next = end_ ? end_->next() : cosim::kNever;
    return next == cosim::kNever ? cosim::kNever : std::max(next, free_);
}

cosim::Time UartLine::due() const {
    const cosim::Time start = start_of_next();
    return start == cosim::kNever ? cosim::kNever : start + kBitsToStop * period_of_next();
}

cosim::Time UartLine::period_of_next() const {
    const cosim::Time own = end_->next_bit_period();
    return own != 0 ? own : bit_period_;
}

void UartLine::deliver() {
    const cosim::Time start = start_of_next();
    cosim::UartFrame frame;
    frame.start = start;
    frame.bit_period = period_of_next();
    frame.data = end_->take();
    free_ = start + kBitsOfFrame * frame.bit_period;
    ++to_chip_;
    const bool heard = target_.uart_enabled(unit_);
    log(start, "rx", frame.data, heard ? "" : "receiver off");
    target_.uart_receive(unit_, frame);
}

protocols::UartReceiver UartLine::receiver() const {
    const cosim::Time partner = end_ ? end_->bit_period() : 0;
    return {.bit_period = partner != 0 ? partner : bit_period_};
}

void UartLine::sent(const cosim::UartFrame& frame) {
    ++from_chip_;
    heard(listener_.add(frame, receiver(), protocols::stop_bit_start(frame)));
}

void UartLine::heard(const std::vector<protocols::ReceivedCharacter>& characters) {
    for (const auto& character : characters) {
        const auto byte = static_cast<std::uint8_t>(character.data);
        if (character.framing_error) ++bad_frames_;
        log(character.start, "tx", byte,
            character.is_break        ? "break"
            : character.framing_error ? "framing"
                                      : "");
        if (end_) end_->receive(byte, !character.framing_error, character.start);
    }
}

void UartLine::poll(cosim::Time now) {
    watch_receiver(now);
    if (listener_.ask_again() <= now) heard(listener_.pass(receiver(), now));
    if (end_) end_->poll(now, listening_since_);
}

void UartLine::watch_receiver(cosim::Time now) {
    const std::size_t resets = target_.resets();
    if (!target_.uart_enabled(unit_))
        listening_since_ = cosim::kNever;
    else if (listening_since_ == cosim::kNever || resets != resets_)
        listening_since_ = now;
    resets_ = resets;
    const dspic::UartCounters counters = target_.uart_counters(unit_);
    for (auto n = counters_.framing_errors; n < counters.framing_errors; ++n)
        log(now, "rx", -1, "framing");
    for (auto n = counters_.parity_errors; n < counters.parity_errors; ++n)
        log(now, "rx", -1, "parity");
    for (auto n = counters_.overruns; n < counters.overruns; ++n)
        log(now, "rx", -1, "overrun");
    counters_ = counters;
}

void UartLine::log(cosim::Time time, const char* direction, int byte, const char* error) {
    if (logs_ != nullptr) logs_->uart(unit_, time, direction, byte, error);
}

}  // namespace puckloop::exec
