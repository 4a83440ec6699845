#include "linuxboard/shim/devices/tty_port.h"

#include <algorithm>
#include <bit>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;
using cosim::UartFrame;

namespace {
/// Idle characters after which a FIFO below its trigger level is handed on.
constexpr int kTimeoutCharacters = 4;
}  // namespace

void TtyPort::open() {
    if (opens_++ == 0) {
        hung_up_ = false;
        stopped_ = false;
        discipline_.discard();
        arriving_.clear();
        listener_.reset();
        last_input_ = kNever;
    }
}

void TtyPort::close() {
    if (opens_ > 0 && --opens_ == 0) {
        discipline_.discard();
        arriving_.clear();
        listener_.reset();
    }
}

void TtyPort::hang_up() {
    hung_up_ = true;
    discipline_.discard();
    arriving_.clear();
    listener_.reset();
    output_.clear();
}

bool TtyPort::hears(const protocols::UartReceiver& receiver) const {
    return is_open() && !hung_up_ && (settings_.c_cflag & CREAD) != 0 && receiver.bit_period != 0;
}

bool TtyPort::fills(const UartFrame& frame) const {
    const protocols::UartReceiver receiver = receiver_of(settings_, rate_ppm_);
    if (!hears(receiver)) return false;
    if (!listener_.samples_alone(frame)) return true;  // it may
    const std::size_t characters = protocols::sample_frame(frame, receiver, listener_.ready()).size();
    return arriving_.size() + characters >= static_cast<std::size_t>(trigger_);
}

void TtyPort::deliver(const UartFrame& frame, Time delivered) {
    const protocols::UartReceiver receiver = receiver_of(settings_, rate_ppm_);
    if (!hears(receiver)) return;
    arrive(listener_.add(frame, receiver, delivered), delivered);
}

void TtyPort::arrive(const std::vector<protocols::ReceivedCharacter>& characters, Time known) {
    for (const auto& character : characters)
        arriving_.push_back({std::max(character.time, known), character});
}

void TtyPort::take(const protocols::ReceivedCharacter& character) {
    ++counters_.received;
    if (character.is_break) {
        ++counters_.breaks;
    } else if (character.framing_error) {
        ++counters_.framing;
    } else if (character.parity_error) {
        ++counters_.parity;
    }
    discipline(character);
}

void TtyPort::insert(char byte, Time now) {
    last_input_ = now;
    protocols::ReceivedCharacter character;
    character.data = static_cast<std::uint8_t>(byte);
    discipline(character);
}

void TtyPort::discipline(const protocols::ReceivedCharacter& character) {
    const LineDiscipline::Effect effect = discipline_.receive(character, settings_);
    if (effect.stop_output) stopped_ = true;
    if (effect.start_output) start_output(last_input_);
    if (!effect.echo.empty()) {
        for (const char byte : effect.echo) {
            if (output_room() > 0) output_.push_back({byte, last_input_, 0});
        }
    }
}

void TtyPort::advance(Time now, std::vector<UartFrame>& sent) {
    if (const Time certain = listener_.ask_again(); certain <= now)
        arrive(listener_.pass(receiver_of(settings_, rate_ppm_), certain), certain);
    for (Time due = fifo_due(); due <= now; due = fifo_due()) {
        last_input_ = due;
        while (!arriving_.empty() && arriving_.front().time <= due) {
            const protocols::ReceivedCharacter character = arriving_.front().character;
            arriving_.pop_front();
            take(character);
        }
    }
    while (can_send() && next_frame(0) <= now) {
        const Output next = output_.front();
        output_.pop_front();
        const protocols::UartReceiver format = receiver_of(settings_, rate_ppm_);
        UartFrame frame;
        frame.start = std::max({next.not_before, line_free_, released_});
        frame.bit_period = format.bit_period;
        frame.data_bits = format.data_bits;
        frame.parity = format.parity;
        frame.stop_bits = (settings_.c_cflag & CSTOPB) != 0 ? 2 : 1;
        if (next.break_length > 0) {
            frame.is_break = 1;
        } else {
            frame.data = static_cast<std::uint16_t>(static_cast<unsigned char>(next.byte) &
                                                    ((1u << format.data_bits) - 1));
            const bool odd = std::popcount(frame.data) % 2 == 1;
            if (frame.parity != 0) frame.parity_bit = odd == (frame.parity == 2) ? 1 : 0;
        }
        line_free_ = std::max(protocols::frame_end(frame), frame.start + next.break_length);
        ++counters_.sent;
        sent.push_back(frame);
    }
}

Time TtyPort::fifo_due() const {
    if (arriving_.empty()) return kNever;
    const auto level = static_cast<std::size_t>(trigger_);
    const Time full = arriving_.size() >= level ? arriving_[level - 1].time : kNever;
    if (trigger_ == 1) return next_tick(full);
    const protocols::UartReceiver format = receiver_of(settings_, rate_ppm_);
    const int bits = 2 + format.data_bits + (format.parity != 0 ? 1 : 0);
    const Time pause = kTimeoutCharacters * bits * format.bit_period;
    Time idle = kNever;
    for (std::size_t i = 0; i < arriving_.size() && idle == kNever; ++i) {
        const Time until = arriving_[i].time + pause;
        if (i + 1 == arriving_.size() || arriving_[i + 1].time > until) idle = until;
    }
    return next_tick(std::min(full, idle));
}

Time TtyPort::next_tick(Time time) const {
    if (batch_ == 0 || time > kNever - batch_) return time;
    return (time + batch_ - 1) / batch_ * batch_;
}

Time TtyPort::next_frame(Time now) const {
    if (!can_send()) return kNever;
    return std::max({output_.front().not_before, line_free_, released_, now});
}

Time TtyPort::next_event() const {
    return std::min({next_frame(0), fifo_due(), listener_.ask_again()});
}

bool TtyPort::echoes() const {
    return is_open() && ((settings_.c_lflag & (ECHO | ECHONL)) != 0 || (settings_.c_iflag & IXON) != 0);
}

bool TtyPort::input_ready() const {
    if (hung_up_) return true;
    if (canonical()) return discipline_.has_line();
    const std::size_t minimum = settings_.c_cc[VMIN];
    const std::size_t needed = settings_.c_cc[VTIME] == 0 && minimum > 0 ? minimum : 1;
    return discipline_.readable(settings_) >= needed;
}

void TtyPort::show(wire::TtyView& view) const {
    view.usable = is_open() ? 1 : 0;
    if (view.usable == 0) return;
    view.hung_up = hung_up_ ? 1 : 0;
    view.canonical = canonical() ? 1 : 0;
    view.has_line = discipline_.has_line() ? 1 : 0;
    view.raw_output = (settings_.c_oflag & OPOST) == 0 ? 1 : 0;
    view.minimum = settings_.c_cc[VMIN];
    view.pause = settings_.c_cc[VTIME];
    view.readable = static_cast<std::uint32_t>(input_queue());
    view.room = static_cast<std::uint32_t>(output_room());
    view.first = 0;
    view.shown = view.canonical != 0 ? 0 : std::min(view.readable, wire::TtyView::kShown);
    discipline_.copy(view.shown, view.input);
}

std::size_t TtyPort::write(std::string_view data, Time now) {
    std::size_t taken = 0;
    for (const char byte : data) {
        const std::string out = LineDiscipline::output(byte, settings_);
        if (output_room() < out.size()) break;
        for (const char wire_byte : out)
            output_.push_back({wire_byte, now, 0});
        ++taken;
    }
    return taken;
}

void TtyPort::send_break(Time now, Time length) {
    output_.push_back({0, now, std::max<Time>(length, 1)});
}

void TtyPort::configure(const termios& settings) {
    const bool leaves_canonical = canonical() && (settings.c_lflag & ICANON) == 0;
    settings_ = settings;
    cfsetispeed(&settings_, cfgetospeed(&settings_));
    if (leaves_canonical) stopped_ = false;
}

void TtyPort::flush_output() {
    output_.clear();
}

void TtyPort::start_output(Time now) {
    if (!stopped_) return;
    stopped_ = false;
    released_ = now;
}

wire::TtyCounters TtyPort::counters() const {
    wire::TtyCounters counters = counters_;
    counters.buffer_overrun = static_cast<std::uint32_t>(discipline_.dropped());
    return counters;
}

}  // namespace puckloop::linuxboard
