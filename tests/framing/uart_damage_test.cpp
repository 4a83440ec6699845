// Lines whose levels faults have damaged, drawn at random: what each chip's receiver and the Linux port's
// take off them, against reference receivers that sample the damage as it was meant, painted apart.

#include "base/random.h"
#include "cosim/faults/faults.h"
#include "protocols/serial/uart_line.h"
#include "tests/framing/uart_chips.h"
#include "tests/framing/uart_wave.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::framing;
using cosim::Delivery;
using cosim::FaultSpec;
using cosim::Time;
using cosim::UartFrame;

namespace {

constexpr int kWords = 10;
constexpr Time kNs = cosim::kNanosecond;

/// A line with one fault: what arrives, and what its levels are to be.
struct Damaged {
    std::vector<Delivery> deliveries;  ///< in order
    Wave wave;
    Time end = 0;
    std::uint64_t fired = 0;
    std::string what;
};

double ps(Time time) {
    return static_cast<double>(time);
}
Time draw(RandomStream& random, Time below) {
    return static_cast<Time>(random.below(static_cast<std::uint64_t>(below)));
}
Time whole_ns(double picoseconds) {
    return std::llround(picoseconds / 1e3) * kNs;
}

class Scene {
  public:
    Scene(RandomStream& random, const Format& format, Time bit)
        : random_(random), format_(format), bit_(bit) {
        Time at = 5 * cosim::kMillisecond + draw(bit);
        for (int i = 0; i < kWords; ++i) {
            starts_.push_back(at);
            at += frame_length();
            if (random.below(2)) at += 20 * bit + draw(20 * bit);  // a pause, else back to back
        }
        out_.end = at + 60 * bit;
    }

    Damaged with(const char* kind) {
        spec_.link = "line";
        spec_.kind = kind;
        spec_.begin = 0;
        out_.what = kind;
        std::vector<UartFrame> frames;
        for (const Time start : starts_) {
            const auto data = static_cast<std::uint16_t>(random_.below(1u << format_.data_bits));
            frames.push_back(frame_of(format_, data, start, bit_));
            out_.wave.word(format_, data, start, bit_);
        }
        if (out_.what == "glitch") glitch();
        if (out_.what == "stop") stop();
        if (out_.what == "invert") invert();
        if (out_.what == "false_start" || out_.what == "break") pulse();
        send(frames);
        return out_;
    }

  private:
    Time draw(Time below) { return ::draw(random_, below); }
    Time frame_length() const { return bit_ * (format_.bits_before_stop() + format_.stop_bits); }

    void glitch() {
        // From far below a sampling clock to several bits.
        const Time width = whole_ns(ps(bit_) * std::pow(10.0, -2 + 2.5 * random_.uniform()) + 1e3);
        const Time at = whole_ns(ps(frame_length()) * random_.uniform());
        spec_.set("bit", ps(at) / ps(bit_)).set("width", cosim::to_seconds(width));
        for (const Time start : starts_)
            if (at < frame_length())
                out_.wave.flip(start + at, std::min(start + at + width, start + frame_length()));
    }
    void stop() {
        const double length = random_.below(3) ? 0.02 + 0.95 * random_.uniform() : 0.0;
        spec_.set("length", length);
        out_.what += fmt::format(" {:.4f}", length);
        for (const Time start : starts_) {
            const Time stop = start + bit_ * format_.bits_before_stop();
            if (length == 0)
                out_.wave.paint(stop, stop + bit_, false);
            else
                out_.wave.paint(start + whole_ns((format_.bits_before_stop() + length) * ps(bit_)),
                                start + frame_length(), false);
        }
    }
    void invert() {
        const Time span = starts_.back() - starts_.front();
        spec_.begin = starts_.front() - 10 * bit_ + draw(span);
        spec_.end = spec_.begin + 1 + draw(span);
        out_.wave.flip(spec_.begin, spec_.end);
    }
    /// On the line at rest, so that what follows is not disturbed, or is soon.
    void pulse() {
        const Time last = starts_.back() + frame_length();
        spec_.begin = random_.below(2) ? last + bit_ + draw(bit_) : starts_.front() - draw(20 * bit_) - bit_;
        const bool is_break = out_.what == "break";
        const Time room = spec_.begin > last || is_break ? 40 * bit_ : starts_.front() - spec_.begin;
        // A break as long as a character, at least; a pulse of any length.
        Time width = is_break ? 13 * bit_ + draw(20 * bit_) : bit_ / 50 + draw(2 * bit_);
        if (is_break && spec_.begin < last) spec_.begin = starts_.front() - 34 * bit_;
        width = std::max<Time>(10, std::min(width, room) / 10 * 10);
        if (!is_break) width = whole_ns(ps(width) + 1e3);
        spec_.set(is_break ? "length" : "width", cosim::to_seconds(width));
        out_.wave.paint(spec_.begin,
                        std::min(spec_.begin + width, spec_.begin > last ? out_.end : starts_[0]), false);
    }
    void send(const std::vector<UartFrame>& frames) {
        const Time flight = bit_ * format_.bits_before_stop();
        const auto fault = cosim::make_fault(
            spec_, {cosim::Direction::FromA, flight, 0, cosim::PlaceKind::Uart, "sender"}, 1, 0);
        out_.deliveries = fault->preset();
        std::uint64_t sent = 0;
        for (const UartFrame& frame : frames) {
            const Time time = frame.start + flight;
            std::vector<Delivery> batch{{cosim::Message{time, 0, frame}, cosim::FaultKind::None}};
            fault->apply(batch, {time, sent++});
            out_.deliveries.insert(out_.deliveries.end(), batch.begin(), batch.end());
        }
        std::stable_sort(
            out_.deliveries.begin(), out_.deliveries.end(),
            [](const Delivery& a, const Delivery& b) { return a.message.time < b.message.time; });
        out_.fired = fault->evidence().fired();
    }

    RandomStream& random_;
    Format format_;
    Time bit_;
    std::vector<Time> starts_;
    FaultSpec spec_;
    Damaged out_;
};

const UartFrame& frame_in(const Delivery& delivery) {
    return std::get<UartFrame>(delivery.message.payload);
}

std::vector<Character> hear(UartChip& chip, const Damaged& line) {
    std::vector<Character> heard;
    const auto take = [&] {
        const auto some = chip.take();
        heard.insert(heard.end(), some.begin(), some.end());
    };
    for (const Delivery& delivery : line.deliveries) {
        chip.deliver(frame_in(delivery), delivery.message.time);
        take();
    }
    // In steps, so that the buffer never overruns.
    const Time last = line.deliveries.back().message.time;
    for (Time time = last; time < line.end; time += (line.end - last) / 20 + 1) {
        chip.run_to(time);
        take();
    }
    chip.run_to(line.end);
    take();
    return heard;
}

/// Each bit once, in its middle counted from the edge.
struct Ideal {
    std::vector<Character> characters;
    std::vector<bool> breaks;
};
Ideal listen_ideal(const Wave& wave, Time end, const Format& format, Time bit) {
    Ideal out;
    for (Time edge = 0; (edge = wave.next_edge(edge)) < end;) {
        if (wave.level(edge)) continue;
        Time at = edge + bit / 2;
        if (wave.level(at)) {
            edge = at;
            continue;
        }
        const auto next = [&] { return wave.level(at += bit); };
        Character one;
        int ones = 0;
        for (int i = 0; i < format.data_bits; ++i) {
            const bool high = next();
            one.data = static_cast<std::uint16_t>(one.data | high << i);
            ones += high;
        }
        bool any = ones != 0;
        if (format.parity) {
            const bool high = next();
            any = any || high;
            one.parity = ((ones + high) % 2 == 1) != (format.parity == 1);
        }
        one.framing = !next();
        out.characters.push_back(one);
        out.breaks.push_back(!any && one.framing);
        edge = at;
    }
    return out;
}

Ideal hear_ideal(const Damaged& line, const Format& format, Time bit) {
    const protocols::UartReceiver receiver{bit, static_cast<std::uint8_t>(format.data_bits),
                                           static_cast<std::uint8_t>(format.parity)};
    protocols::UartListener listener;
    Ideal out;
    const auto take = [&](const std::vector<protocols::ReceivedCharacter>& some) {
        for (const auto& one : some) {
            out.characters.push_back({one.data, one.framing_error, one.parity_error});
            out.breaks.push_back(one.is_break);
        }
    };
    const auto pass = [&](Time until) {
        while (listener.ask_again() <= until)
            take(listener.pass(receiver, listener.ask_again()));
    };
    for (const Delivery& delivery : line.deliveries) {
        pass(delivery.message.time);
        take(listener.add(frame_in(delivery), receiver, delivery.message.time));
    }
    pass(line.end + cosim::kSecond);
    return out;
}

std::string text(const std::vector<Character>& heard) {
    std::string out;
    for (const Character& one : heard)
        out += fmt::format("{:03x}{}{}{} ", one.data, one.framing ? "F" : "", one.parity ? "P" : "",
                           one.overrun ? "O" : "");
    return out;
}

constexpr const char* kDamages[] = {"glitch", "glitch", "stop", "invert", "false_start", "break"};

}  // namespace

TEST_CASE("uart damage: every chip hears the levels on the line") {
    RandomStream random(61, "damaged lines");
    for (const ChipKind& kind : chip_kinds()) {
        int framing = 0, parity = 0, changed = 0;
        for (int round = 0; round < 150; ++round) {
            const Format& format = kind.formats[random.below(kind.formats.size())];
            const auto chip = kind.make(0);
            chip->set(format, static_cast<std::uint32_t>(6 + random.below(60)));
            const double mismatch = 0.02 * (random.uniform() - 0.5);
            const Time bit = std::llround(chip->bit_seconds() * 1e12 * (1 + mismatch));
            const Damaged line = Scene(random, format, bit).with(kDamages[random.below(std::size(kDamages))]);
            INFO(kind.name << " round " << round << ' ' << line.what << ' ' << format.data_bits
                           << "NOE"[format.parity] << format.stop_bits << " bit " << bit);
            CHECK(line.fired > 0);
            const auto heard = hear(*chip, line);
            const auto right = listen([&](Time time) { return line.wave.level(time); }, line.end, format,
                                      kind.ticks, [&](std::int64_t n) { return chip->tick(n); });
            REQUIRE(text(heard) == text(right));
            for (const Character& one : heard) {
                framing += one.framing;
                parity += one.parity;
            }
            changed += heard.size() != static_cast<std::size_t>(kWords);
        }
        CHECK(framing > 50);
        CHECK(parity > 5);
        CHECK(changed > 10);
    }
}

TEST_CASE("uart damage: the Linux port hears the levels on the line") {
    RandomStream random(62, "damaged lines");
    int framing = 0, breaks = 0;
    for (int round = 0; round < 600; ++round) {
        const Format format{static_cast<int>(5 + random.below(4)), static_cast<int>(random.below(3)),
                            static_cast<int>(1 + random.below(2))};
        const Time own = cosim::kMicrosecond + static_cast<Time>(random.below(100 * cosim::kMicrosecond));
        const Time bit = std::llround(static_cast<double>(own) * (1 + 0.02 * (random.uniform() - 0.5)));
        const Damaged line = Scene(random, format, bit).with(kDamages[random.below(std::size(kDamages))]);
        INFO("round " << round << ' ' << line.what << ' ' << format.data_bits << "NOE"[format.parity]
                      << format.stop_bits << " bit " << bit << " own " << own);
        const Ideal heard = hear_ideal(line, format, own),
                    right = listen_ideal(line.wave, line.end, format, own);
        REQUIRE(text(heard.characters) == text(right.characters));
        REQUIRE(heard.breaks == right.breaks);
        for (std::size_t i = 0; i < heard.breaks.size(); ++i) {
            framing += heard.characters[i].framing;
            breaks += heard.breaks[i];
        }
    }
    CHECK(framing > 200);
    CHECK(breaks > 20);
}

TEST_CASE("uart damage: a pulse of less than a sampling clock is outvoted, one of two clocks is not") {
    RandomStream random(63, "outvoted");
    for (const ChipKind& kind : chip_kinds()) {
        int wrong_short = 0, wrong_long = 0;
        for (int round = 0; round < 60; ++round) {
            const Format& format = kind.formats[random.below(kind.formats.size())];
            const bool is_short = round % 2 == 0;
            const auto chip = kind.make(0);
            chip->set(format, static_cast<std::uint32_t>(6 + random.below(60)));
            const Time bit = std::llround(chip->bit_seconds() * 1e12);
            const double clock = 1.0 / kind.ticks;
            // Short: anywhere up to the stop bit's middle. Long: around the samples of a data bit.
            const double width = (is_short ? 0.97 : 2.03) * clock;
            const double at = is_short ? (format.bits_before_stop() + 0.4) * random.uniform()
                                       : 1.5 + static_cast<double>(random.below(5)) - clock / 2;
            FaultSpec spec;
            spec.link = "line";
            spec.kind = "glitch";
            spec.set("bit", at).set("width", width * ps(bit) / 1e12);
            const auto fault = cosim::make_fault(
                spec, {cosim::Direction::FromA, 9 * bit, 0, cosim::PlaceKind::Uart, "s"}, 1, 0);
            const auto data = static_cast<std::uint16_t>(random.below(1u << format.data_bits));
            const UartFrame frame = frame_of(format, data, cosim::kMillisecond + draw(random, bit), bit);
            const Time stop = frame.start + bit * format.bits_before_stop();
            std::vector<Delivery> batch{{cosim::Message{stop, 0, frame}, cosim::FaultKind::None}};
            fault->apply(batch, {stop, 0});
            chip->deliver(frame_in(batch.at(0)), stop);
            chip->run_to(stop + 20 * bit);
            const auto heard = chip->take();
            (is_short ? wrong_short : wrong_long) += heard != std::vector<Character>{{data}};
        }
        INFO(kind.name << ": short " << wrong_short << " long " << wrong_long);
        CHECK(wrong_long == 30);
        CHECK((wrong_short == 0) == (kind.ticks >= 8));
    }
}
