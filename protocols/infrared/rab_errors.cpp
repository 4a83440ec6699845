#include "protocols/infrared/rab_errors.h"

#include "protocols/infrared/rab_frame.h"

#include <string>

namespace puckloop::protocols {

namespace {

/// One frame as sent, and what became of its corrupted copies.
class Channel {
  public:
    Channel(int size, std::uint32_t payload)
        : size_(size), payload_(payload), sent_(encode_rab(size, payload)) {}

    const std::string& sent() const { return sent_; }
    const RabErrorCount& count() const { return count_; }

    void receive(std::string_view chips) {
        const RabFrameReading reading = decode_rab(chips, size_);
        switch (reading.fault) {
        case RabFault::Preamble:
            ++count_.preamble;
            break;
        case RabFault::Manchester:
            ++count_.manchester;
            break;
        case RabFault::Length:
            ++count_.length;
            break;
        case RabFault::Check:
            ++count_.check;
            break;
        case RabFault::None:
            ++(reading.check == rab_check(payload_) ? count_.missed_swap : count_.missed_followed);
            break;
        }
    }

  private:
    int size_;
    std::uint32_t payload_;
    std::string sent_;
    RabErrorCount count_;
};

void invert(std::string& chips, std::size_t at) {
    chips[at] = chips[at] == '0' ? '1' : '0';
}

void invert_chips(Channel& channel) {
    std::string chips = channel.sent();
    for (std::size_t i = 0; i < chips.size(); ++i) {
        invert(chips, i);
        channel.receive(chips);
        invert(chips, i);
    }
}

/// Inverts `width` chips in two places each: single chips anywhere, or whole bits after the preamble.
void invert_pairs(Channel& channel, std::size_t first, std::size_t width) {
    std::string chips = channel.sent();
    const auto flip = [&](std::size_t at) {
        for (std::size_t k = 0; k < width; ++k)
            invert(chips, at + k);
    };
    for (std::size_t i = first; i < chips.size(); i += width) {
        flip(i);
        for (std::size_t j = i + width; j < chips.size(); j += width) {
            flip(j);
            channel.receive(chips);
            flip(j);
        }
        flip(i);
    }
}

void lose_chips(Channel& channel) {
    for (std::size_t i = 0; i < channel.sent().size(); ++i) {
        std::string chips = channel.sent();
        channel.receive(chips.erase(i, 1));
    }
}

void add_chips(Channel& channel) {
    for (std::size_t i = 0; i <= channel.sent().size(); ++i) {
        for (const char added : {'0', '1'}) {
            std::string chips = channel.sent();
            channel.receive(chips.insert(i, 1, added));
        }
    }
}

}  // namespace

std::string_view name_of(RabError error) {
    constexpr std::array<std::string_view, kRabErrors.size()> kNames{
        "one chip inverted", "two chips inverted", "one chip lost", "one chip added", "two bits flipped"};
    return kNames.at(static_cast<std::size_t>(error));
}

RabErrorCount count_rab_errors(RabError error, int size, std::uint32_t payload) {
    Channel channel(size, payload);
    switch (error) {
    case RabError::OneInverted:
        invert_chips(channel);
        break;
    case RabError::TwoInverted:
        invert_pairs(channel, 0, 1);
        break;
    case RabError::OneLost:
        lose_chips(channel);
        break;
    case RabError::OneAdded:
        add_chips(channel);
        break;
    case RabError::TwoBits:
        invert_pairs(channel, kRabPreambleChips, 2);
        break;
    }
    return channel.count();
}

}  // namespace puckloop::protocols
