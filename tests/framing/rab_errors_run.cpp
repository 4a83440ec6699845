#include "tests/framing/rab_errors_run.h"

#include "base/random.h"
#include "protocols/infrared/rab_frame.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>

namespace puckloop::framing {

using firmware::kChip;
using firmware::RabBench;
using protocols::encode_rab;

namespace {

constexpr double kRead = 300e-6;    // s for one register at 400 kHz with what firmware stretches
constexpr double kPause = 0.0035;   // s behind the reads: any decoder has seen silence
constexpr double kDelay = 8e-6;     // s, the demodulator's, both ways
constexpr std::size_t kTexts = 33;  // a bench keeps a thousand reads, each text takes thirty
constexpr int kSensor = 1;
constexpr int kPeak = 900;

struct Popped {
    bool there = false;
    std::uint32_t data = 0;
};

/// A bench with what was planned on it so far.
class Plan {
  public:
    Plan(const RabReceiver& receiver, int size, std::uint64_t seed)
        : receiver_(receiver), size_(size), random_(seed, "rab frames"), bench_(receiver.image) {
        bench_.master.clock_hertz = 400e3;
        time_ = receiver.ready;
        bench_.write(time_, {21, static_cast<std::uint8_t>(size)});
        time_ += kPause;
    }
    std::uint32_t draw_payload() { return static_cast<std::uint32_t>(random_.next() >> 32) >> (32 - size_); }
    /// Light by a text of chips at a drawn phase, then two pops of a message.
    void frame(const std::string& chips, double jitter = 0, double longer = 1) {
        time_ += random_.uniform() * kChip;
        char before = '0';
        double last = 0;
        for (std::size_t i = 0; i <= chips.size(); ++i) {
            const char now = i < chips.size() ? chips[i] : '0';
            if (now == before) continue;
            before = now;
            double edge = static_cast<double>(i) * longer + jitter * (2 * random_.uniform() - 1);
            edge = std::max(edge, last + 0.02);  // edges keep their order
            last = edge;
            const double at = time_ + edge * kChip;
            bench_.signal(at, "peak" + std::to_string(kSensor + 1), now == '1' ? kPeak : 0);
            bench_.signal(at + kDelay, "demod" + std::to_string(kSensor + 1), now == '1' ? 1 : 0);
        }
        time_ += static_cast<double>(chips.size()) * longer * kChip + receiver_.readable;
        for (int pop = 0; pop < 2; ++pop)
            for (const int number : {0, 10, 11, 1, 2}) {
                bench_.read(time_, number);
                time_ += kRead;
            }
        time_ += kPause;
    }
    void run() { bench_.run(time_); }
    /// The two pops behind frame number `frame`; after run().
    std::vector<Popped> popped(std::size_t frame) const {
        std::vector<Popped> out;
        for (std::size_t pop = 0; pop < 2; ++pop) {
            const auto byte = [&](std::size_t i) -> std::uint32_t {
                return bench_.reads().at((frame * 2 + pop) * 5 + i).at(0);
            };
            if (byte(0) == 1)
                out.push_back({true, (byte(1) << 24 | byte(2) << 16 | byte(3) << 8 | byte(4)) &
                                         (0xFFFFFFFFu >> (32 - size_))});
        }
        return out;
    }

  private:
    const RabReceiver& receiver_;
    int size_;
    RandomStream random_;
    RabBench bench_;
    double time_ = 0;
};

bool has(const std::vector<Popped>& popped, std::uint32_t payload) {
    for (const Popped& one : popped)
        if (one.data == payload) return true;
    return false;
}

/// A message that is none of the two payloads.
bool has_other(const std::vector<Popped>& popped, std::uint32_t payload, std::uint32_t also) {
    for (const Popped& one : popped)
        if (one.data != payload && one.data != also) return true;
    return false;
}

RabOutcome judge(const Plan& plan, std::size_t text, std::uint32_t payload, std::uint32_t good,
                 std::uint32_t after) {
    const auto first = plan.popped(3 * text), second = plan.popped(3 * text + 1),
               third = plan.popped(3 * text + 2);
    RabOutcome out;
    out.accepted_right = has(first, payload);
    out.accepted_wrong = has_other(first, payload, payload) || has_other(second, payload, good) ||
                         has_other(third, good, after);
    out.next_lost = !has(second, good);
    out.second_lost = !has(third, after);
    return out;
}

}  // namespace

RabReceiver own_rab_receiver() {
    return {"rab.hex", std::string(PUCKLOOP_FIRMWARE) + "/rab/rab.hex", 0.02, 0.002};
}

std::vector<RabReceiver> rab_receivers() {
    std::vector<RabReceiver> all{own_rab_receiver()};
    if (const auto image = exec::real_image("randb.hex")) all.push_back({"randb.hex", *image, 0.1, 0.0035});
    return all;
}

std::vector<RabOutcome> send_wrong_frames(const RabReceiver& receiver, int size, std::uint32_t payload,
                                          const std::vector<std::string>& texts, std::uint64_t seed) {
    std::vector<RabOutcome> outcomes;
    for (std::size_t begin = 0; begin < texts.size(); begin += kTexts) {
        const std::size_t end = std::min(texts.size(), begin + kTexts);
        Plan plan(receiver, size, seed + begin);
        std::vector<std::uint32_t> good;
        for (std::size_t i = begin; i < end; ++i) {
            plan.frame(texts[i]);
            for (int j = 0; j < 2; ++j) {
                std::uint32_t other = plan.draw_payload();
                while (other == payload)
                    other = plan.draw_payload();
                good.push_back(other);
                plan.frame(encode_rab(size, other));
            }
        }
        plan.run();
        for (std::size_t i = 0; i < end - begin; ++i)
            outcomes.push_back(judge(plan, i, payload, good[2 * i], good[2 * i + 1]));
    }
    return outcomes;
}

Delivery send_jittered(const RabReceiver& receiver, int size, double jitter, double longer, int frames,
                       std::uint64_t seed) {
    Delivery out;
    for (int begin = 0; begin < frames; begin += static_cast<int>(kTexts)) {
        Plan plan(receiver, size, seed + static_cast<std::uint64_t>(begin));
        std::vector<std::uint32_t> payloads;
        const int end = std::min(frames, begin + static_cast<int>(kTexts));
        for (int i = begin; i < end; ++i) {
            payloads.push_back(plan.draw_payload());
            plan.frame(encode_rab(size, payloads.back()), jitter, longer);
            // Good frames put a decoder right that a bad one left in the middle of a frame.
            for (int good = 0; good < 2; ++good)
                plan.frame(encode_rab(size, 0));
        }
        plan.run();
        for (std::size_t i = 0; i < payloads.size(); ++i) {
            const auto popped = plan.popped(3 * i);
            ++out.sent;
            out.right += has(popped, payloads[i]);
            out.wrong += has_other(popped, payloads[i], 0);
        }
    }
    return out;
}

}  // namespace puckloop::framing
