#include "cosim/faults/faults.h"

#include "base/error.h"
#include "base/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace puckloop::cosim {

namespace {

constexpr std::array<std::string_view, 9> kNames{"",           "drop",  "flip", "delay", "duplicate",
                                                 "disconnect", "stuck", "rate", "cut"};
constexpr int kPauseFrames = 2;  // frame times without a start bit: a record has ended
// A bit slower than 1/64 or faster than 64 times the sender's is no clock error but a mistake in the spec.
constexpr double kLargestRateFactor = 64.0;

Time frame_time(const UartFrame& frame) {
    const int bits = 1 + frame.data_bits + (frame.parity != 0 ? 1 : 0) + frame.stop_bits;
    return frame.bit_period * bits;
}
Time frame_time(const RadioFrame& frame) {
    return frame.duration;
}

/// True where a frame carries one of `bytes`, or they are none; radio frames carry no single byte.
bool is_among(const std::vector<std::uint8_t>& bytes, const UartFrame& frame) {
    return bytes.empty() || std::find(bytes.begin(), bytes.end(), frame.data) != bytes.end();
}
bool is_among(const std::vector<std::uint8_t>& bytes, const RadioFrame&) {
    return bytes.empty();
}

void flip(UartFrame& frame, RandomStream& random) {
    frame.data = static_cast<std::uint16_t>(frame.data ^ (1u << random.below(frame.data_bits)));
}
void flip(RadioFrame& frame, RandomStream& random) {
    const auto view = frame.octets.view();
    if (view.empty()) return;
    std::vector<std::uint8_t> octets(view.begin(), view.end());
    const std::uint64_t bit = random.below(8 * octets.size());
    octets[bit / 8] = static_cast<std::uint8_t>(octets[bit / 8] ^ 1u << bit % 8);
    frame.octets = Octets(octets);
}

/// A radio frame without a duration is no frame on air (emu/radio/control.h).
bool travels(const UartFrame&) {
    return true;
}
bool travels(const RadioFrame& frame) {
    return frame.duration > 0;
}

/// Calls work(frame) for a UART or radio frame; for anything else the result is `Result{}`.
template <class Result>
Result with_frame(Payload& payload, auto work) {
    if (auto* frame = std::get_if<UartFrame>(&payload)) return work(*frame);
    if (auto* radio = std::get_if<RadioFrame>(&payload)) return work(*radio);
    return Result{};
}

/// Decides which frames suffer; the kinds below say how.
class WindowFault : public LinkFault {
  public:
    WindowFault(const FaultSpec& spec, RandomStream random) : spec_(spec), random_(random) {}

    void apply(std::vector<Delivery>& batch) final {
        // What earlier faults appended suffers as well, what this one appends does not.
        const std::size_t count = batch.size();
        for (std::size_t i = 0; i < count; ++i) {
            if (keeps_from_arriving(batch[i].fault) || fired_ >= spec_.count) continue;
            const bool meant = with_frame<bool>(batch[i].message.payload, [this](const auto& frame) {
                return travels(frame) && frame.start >= spec_.begin && frame.start < spec_.end &&
                       is_among(spec_.bytes, frame);
            });
            if (!meant) continue;
            if (spec_.probability < 1.0 && random_.uniform() >= spec_.probability) continue;
            ++fired_;
            batch[i].fault = spec_.kind;
            harm(i, batch);
        }
    }

  protected:
    virtual void harm(std::size_t i, std::vector<Delivery>& batch) = 0;

    static void shift(Message& message, Time delay) {
        with_frame<void>(message.payload, [delay](auto& frame) { frame.start += delay; });
        message.time = later(message.time, delay);
    }

    FaultSpec spec_;
    RandomStream random_;
};

/// Drop and Disconnect: the mark alone keeps the frame from arriving.
class Lose : public WindowFault {
  public:
    using WindowFault::WindowFault;

  protected:
    void harm(std::size_t, std::vector<Delivery>&) override {}
};

class Flip : public WindowFault {
  public:
    using WindowFault::WindowFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        with_frame<void>(batch[i].message.payload, [this](auto& frame) { flip(frame, random_); });
    }
};

class Late : public WindowFault {
  public:
    using WindowFault::WindowFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        shift(batch[i].message, from_seconds(spec_.amount));
    }
};

class Twice : public WindowFault {
  public:
    using WindowFault::WindowFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        Delivery copy = batch[i];
        shift(copy.message,
              with_frame<Time>(copy.message.payload, [](const auto& frame) { return frame_time(frame); }));
        batch.push_back(copy);
    }
};

class Rate : public WindowFault {
  public:
    using WindowFault::WindowFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        UartFrame& frame = std::get<UartFrame>(batch[i].message.payload);
        const Time before = frame.bit_period;
        frame.bit_period = std::max<Time>(1, std::llround(static_cast<double>(before) * spec_.amount));
        // The stop bit moves with the bit time; never earlier than the link promised.
        const int bits = 1 + frame.data_bits + (frame.parity != 0 ? 1 : 0);
        const Time shift = (frame.bit_period - before) * bits;
        if (shift > 0) batch[i].message.time = later(batch[i].message.time, shift);
    }
};

/// Cut: radio or line drop out somewhere in a record, for the rest of it. Where is even over the length of
/// the record before.
class Cut : public LinkFault {
  public:
    Cut(const FaultSpec& spec, RandomStream random) : spec_(spec), random_(random) {}

    void apply(std::vector<Delivery>& batch) override {
        for (Delivery& delivery : batch) {
            const auto* frame = std::get_if<UartFrame>(&delivery.message.payload);
            if (!frame || keeps_from_arriving(delivery.fault)) continue;
            if (frame->start > next_ + (kPauseFrames - 1) * frame_time(*frame)) begin_record(frame->start);
            next_ = frame->start + frame_time(*frame);
            if (cut_ && sent_ >= place_) {
                if (sent_ == place_) ++fired_;
                delivery.fault = FaultKind::Cut;
            }
            ++sent_;
        }
    }

  private:
    void begin_record(Time start) {
        const double stays = cut_ ? spec_.again : 0.0;
        const double chance = spec_.probability + (1 - spec_.probability) * stays;
        const bool open = start >= spec_.begin && start < spec_.end && fired_ < spec_.count;
        cut_ = open && random_.uniform() < chance;
        if (cut_) place_ = random_.below(std::max<std::uint64_t>(sent_, 1));
        sent_ = 0;
    }

    FaultSpec spec_;
    RandomStream random_;
    Time next_ = std::numeric_limits<Time>::min() / 2;  // end of the newest frame
    bool cut_ = false;
    std::uint64_t sent_ = 0, place_ = 0;  // frames of this record; the first that is lost
};

class Stuck : public Lose {
  public:
    Stuck(const FaultSpec& spec, RandomStream random, Time flight) : Lose(spec, random), flight_(flight) {}

    std::vector<Delivery> preset() const override {
        UartFrame low;
        low.start = spec_.begin;
        low.bit_period = flight_ / (1 + low.data_bits);
        low.is_break = 1;
        return {{Message{later(spec_.begin, flight_), 0, low}, FaultKind::None}};
    }

  private:
    Time flight_;
};

void check(const FaultSpec& spec) {
    const auto refuse = [&](const char* what, const char* expected) {
        throw InputError("", fmt::format("fault on link {}", spec.link), what, expected);
    };
    if (!(spec.probability >= 0.0 && spec.probability <= 1.0)) refuse("bad probability", "0 to 1");
    if (spec.begin < 0 || spec.end <= spec.begin) refuse("empty time window", "0 <= begin < end");
    if (spec.kind == FaultKind::Delay && !(spec.amount >= 0.0 && spec.amount < 1e6))
        refuse("bad amount of delay", "seconds, 0 to 1e6");
    if (spec.kind == FaultKind::Rate &&
        !(spec.amount >= 1.0 / kLargestRateFactor && spec.amount <= kLargestRateFactor))
        refuse("bad rate factor", "1/64 to 64");
    if (!(spec.again >= 0.0 && spec.again <= 1.0)) refuse("bad probability of staying", "0 to 1");
}

}  // namespace

std::string_view fault_name(FaultKind kind) {
    return kNames.at(static_cast<std::size_t>(kind));
}

std::optional<FaultKind> fault_of_name(std::string_view name) {
    const auto* found = std::find(kNames.begin() + 1, kNames.end(), name);
    if (found == kNames.end()) return std::nullopt;
    return static_cast<FaultKind>(found - kNames.begin());
}

std::unique_ptr<LinkFault> make_fault(const FaultSpec& spec, Direction direction, Time flight,
                                      std::uint64_t seed, std::size_t index) {
    check(spec);
    const RandomStream random(seed,
                              fmt::format("fault/{}/{}/{}", index, spec.link, static_cast<int>(direction)));
    switch (spec.kind) {
    case FaultKind::Drop:
    case FaultKind::Disconnect:
        return std::make_unique<Lose>(spec, random);
    case FaultKind::Flip:
        return std::make_unique<Flip>(spec, random);
    case FaultKind::Delay:
        return std::make_unique<Late>(spec, random);
    case FaultKind::Duplicate:
        return std::make_unique<Twice>(spec, random);
    case FaultKind::Stuck:
        return std::make_unique<Stuck>(spec, random, flight);
    case FaultKind::Rate:
        return std::make_unique<Rate>(spec, random);
    case FaultKind::Cut:
        return std::make_unique<Cut>(spec, random);
    case FaultKind::None:
        break;
    }
    throw InputError("", fmt::format("fault on link {}", spec.link), "no kind of fault given");
}

std::string describe(const FaultSpec& spec) {
    return fmt::format("{} on {}{}{}", fault_name(spec.kind), spec.link, spec.from.empty() ? "" : " from ",
                       spec.from);
}

}  // namespace puckloop::cosim
