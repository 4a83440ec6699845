// Every error flag of each UART is raised by the matching condition on the line and by no other: conditions,
// words, rates and the driver's reads are drawn at random, and the whole status is compared at every step
// with what the data sheet states that a receiver holds.

#include "base/random.h"
#include "tests/framing/avr_usart_bench.h"
#include "tests/framing/dspic_uart_bench.h"

#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <deque>

using namespace puckloop;
using namespace puckloop::framing;
using cosim::Time;
using cosim::UartFrame;

namespace {

enum class Condition { Good, WrongParity, StopLow, Break, StopLowAndParity, SecondStopLow };
constexpr std::array kConditions{Condition::Good,  Condition::WrongParity,      Condition::StopLow,
                                 Condition::Break, Condition::StopLowAndParity, Condition::SecondStopLow};

struct Sent {
    UartFrame frame;
    Character expected;
};

/// One character on the line with the condition wanted, or, where the format cannot have it, a good one.
Sent make(RandomStream& random, const Format& format, Condition condition, Time start, Time bit) {
    const auto data = static_cast<std::uint16_t>(random.below(1u << format.data_bits));
    Sent sent{frame_of(format, data, start, bit), {data}};
    const bool parity = format.parity != 0;
    if (condition == Condition::Break) {
        sent.frame.is_break = 1;
        sent.expected = {0, true, format.parity == 1, false};  // no ones are even
        return sent;
    }
    const bool wrong_parity = condition == Condition::WrongParity || condition == Condition::StopLowAndParity;
    if (wrong_parity && parity) {
        sent.frame.parity_bit ^= 1;
        sent.expected.parity = true;
    }
    const bool stop_low = condition == Condition::StopLow || condition == Condition::StopLowAndParity;
    // A frame that is longer than the receiver expects puts its own bit where the stop bit should be.
    const int bits = format.data_bits + (parity ? 1 : 0);
    if (condition == Condition::SecondStopLow && format.stop_bits == 2 && bits == 8) {
        sent.frame.data = static_cast<std::uint16_t>(data | 1u << bits);  // a high first stop bit
        sent.frame.data_bits = static_cast<std::uint8_t>(bits + 1);
        sent.frame.parity = 1;
        sent.frame.parity_bit = 0;
        sent.expected.framing = true;
    }
    if (stop_low && bits <= 9) {
        if (parity)
            sent.frame.data = static_cast<std::uint16_t>(data | sent.frame.parity_bit << format.data_bits);
        sent.frame.data_bits = static_cast<std::uint8_t>(bits);
        sent.frame.parity = 1;
        sent.frame.parity_bit = 0;
        sent.expected.framing = true;
    }
    return sent;
}

Time end_of(const UartFrame& frame) {
    return frame.start + frame.bit_period * (frame.data_bits + 4);
}

struct Counts {
    int framing = 0, parity = 0, overruns = 0, read = 0;
};

// ---- dsPIC: four characters, a fifth that is complete sets OERR and nothing more comes in until it is
// cleared.

class DspicOracle {
  public:
    void arrive(const Character& character, Counts& counts) {
        error_ = false;
        received_ = false;
        if (overrun_) return;
        if (fifo_.size() == 4) {
            overrun_ = error_ = true;
            ++counts.overruns;
            return;
        }
        fifo_.push_back(character);
        received_ = true;
        error_ = character.framing || character.parity;
        counts.framing += character.framing;
        counts.parity += character.parity;
    }
    Character read() {
        const Character top = fifo_.front();
        fifo_.pop_front();
        return top;
    }
    void clear() {
        if (overrun_) fifo_.clear();
        overrun_ = false;
    }
    bool empty() const { return fifo_.empty(); }
    std::uint16_t flags() const {
        return static_cast<std::uint16_t>((fifo_.empty() ? 0 : DspicUartBench::kUrxda) |
                                          (overrun_ ? DspicUartBench::kOerr : 0) |
                                          (!fifo_.empty() && fifo_[0].framing ? DspicUartBench::kFerr : 0) |
                                          (!fifo_.empty() && fifo_[0].parity ? DspicUartBench::kPerr : 0));
    }
    bool error() const { return error_; }        ///< by the last arrival: the 33FJ's error interrupt
    bool received() const { return received_; }  ///< by the last arrival: the receive interrupt

  private:
    std::deque<Character> fifo_;
    bool overrun_ = false, error_ = false, received_ = false;
};

constexpr std::uint16_t kDspicFlags = 0xF;

void drive_dspic(bool family_33f, bool high_speed, const Format& format, RandomStream& random,
                 Counts& counts) {
    DspicUartBench bench(family_33f, 0);
    const auto divisor = static_cast<std::uint32_t>(8 + random.below(80));
    bench.enable(format, divisor, high_speed);
    DspicOracle oracle;
    const double own = (high_speed ? 4 : 16) * divisor / bench.clock.hertz() * 1e12;
    for (int step = 0; step < 250; ++step) {
        INFO("33F " << family_33f << " high speed " << high_speed << " bits " << format.data_bits
                    << " parity " << format.parity << " step " << step);
        const std::uint64_t action = random.below(8);
        if (action < 5) {
            const Time bit = std::llround(own * (1 + 0.03 * (random.uniform() - 0.5)));
            const Time start =
                bench.clock.time_of(bench.now) + 2 * bit + static_cast<Time>(random.below(1'000'000));
            const Sent sent = make(random, format, kConditions[random.below(kConditions.size())], start, bit);
            bench.go(bench.clock.first_cycle_at(start + bit * 11));
            bench.uart.receive(sent.frame, bench.now);
            bench.go(bench.clock.first_cycle_at(end_of(sent.frame) + 14 * bit));
            oracle.arrive(sent.expected, counts);
            CHECK(bench.take(bench.setup.rx_irq) == oracle.received());
            if (family_33f) CHECK(bench.take(bench.setup.error_irq) == oracle.error());
        } else if (action < 7) {
            if (!oracle.empty()) {
                ++counts.read;
                CHECK(bench.data() == oracle.read().data);
            }
        } else {
            bench.clear_overrun();
            oracle.clear();
        }
        REQUIRE((bench.sta() & kDspicFlags) == oracle.flags());
    }
}

// ---- ATmega: two characters and a third in the shift register; a further one takes the third's place and
// has DOR.

class AvrOracle {
  public:
    void arrive(Character character, Counts& counts) {
        counts.framing += character.framing;
        counts.parity += character.parity;
        if (fifo_.size() == 3) {
            fifo_.pop_back();
            character.overrun = true;
            ++counts.overruns;
        }
        fifo_.push_back(character);
    }
    Character read() {
        const Character top = fifo_.front();
        fifo_.pop_front();
        return top;
    }
    bool empty() const { return fifo_.empty(); }
    std::uint8_t flags() const {
        if (fifo_.empty()) return 0;
        const Character& top = fifo_.front();
        return static_cast<std::uint8_t>(AvrUsartBench::kRxc | (top.framing ? AvrUsartBench::kFe : 0) |
                                         (top.parity ? AvrUsartBench::kUpe : 0) |
                                         (top.overrun ? AvrUsartBench::kDor : 0));
    }

  private:
    std::deque<Character> fifo_;
};

constexpr std::uint8_t kAvrFlags =
    AvrUsartBench::kRxc | AvrUsartBench::kFe | AvrUsartBench::kUpe | AvrUsartBench::kDor;

void drive_avr(bool double_speed, const Format& format, RandomStream& random, Counts& counts) {
    AvrUsartBench bench(0);
    const auto divisor = static_cast<std::uint32_t>(1 + random.below(100));
    bench.enable(format, divisor, double_speed);
    AvrOracle oracle;
    const double own = (double_speed ? 8 : 16) * divisor / bench.clock.hertz() * 1e12;
    for (int step = 0; step < 250; ++step) {
        INFO("U2X " << double_speed << " bits " << format.data_bits << " parity " << format.parity << " step "
                    << step);
        if (random.below(3) < 2) {
            const Time bit = std::llround(own * (1 + 0.03 * (random.uniform() - 0.5)));
            const Time start =
                bench.clock.time_of(bench.now) + 2 * bit + static_cast<Time>(random.below(1'000'000));
            const Sent sent = make(random, format, kConditions[random.below(kConditions.size())], start, bit);
            bench.go(bench.clock.first_cycle_at(start + bit * 6));
            bench.usart.receive(sent.frame, bench.now);
            bench.go(bench.clock.first_cycle_at(end_of(sent.frame) + 14 * bit));
            oracle.arrive(sent.expected, counts);
        } else if (!oracle.empty()) {
            ++counts.read;
            CHECK(bench.data() == oracle.read().data);
        }
        REQUIRE((bench.status() & kAvrFlags) == oracle.flags());
    }
}

/// The draw reached every flag, often.
void check_reached(const Counts& counts, bool parity) {
    CHECK(counts.framing > 20);
    CHECK(counts.overruns > 5);
    CHECK(counts.read > 20);
    CHECK((counts.parity > 20) == parity);
}

}  // namespace

TEST_CASE("uart flags: the dsPICs' FERR, PERR and OERR come of their own conditions only") {
    RandomStream random(31, "dspic uart flags");
    const auto [family, high] = GENERATE(table<bool, bool>({{false, false}, {true, false}, {true, true}}));
    for (const Format& format :
         {Format{8, 0}, Format{8, 1}, Format{8, 2}, Format{9, 0}, Format{8, 0, 2}, Format{8, 2, 2}}) {
        Counts counts;
        for (int round = 0; round < 3; ++round)
            drive_dspic(family, high, format, random, counts);
        check_reached(counts, format.parity != 0);
    }
}

TEST_CASE("uart flags: the ATmega's FE, UPE and DOR come of their own conditions only") {
    RandomStream random(32, "avr uart flags");
    const bool double_speed = GENERATE(false, true);
    for (const Format& format : {Format{8, 0}, Format{8, 1}, Format{8, 2}, Format{9, 0}, Format{9, 1},
                                 Format{7, 2}, Format{6, 0}, Format{5, 1}}) {
        Counts counts;
        for (int round = 0; round < 3; ++round)
            drive_avr(double_speed, format, random, counts);
        check_reached(counts, format.parity != 0);
    }
}
