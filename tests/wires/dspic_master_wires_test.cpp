// The master of a dsPIC's I2C module with drawn actions of its program against drawn slaves and masters,
// against the wires (wire_master.h): requests while another is under way, bytes that nobody fetched, bytes
// refused, arbitration lost at any bit, what follows a byte that was not acknowledged.

#include "base/random.h"
#include "emu/dspic/peripherals/i2c_master.h"
#include "tests/dspic/peripheral_bench.h"
#include "tests/wires/wire_master.h"
#include "tests/wires/wire_slave.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::wires;
using namespace puckloop::dspic;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;

namespace {

using Activity = WireMaster::Activity;

constexpr std::uint16_t kEnable = 0x8000;
constexpr std::uint16_t kRequests = 0x1F, kAckdt = 0x20;
constexpr Cycle kLong = 100'000;

struct MasterBench : dspic::test::Bench {
    Ports ports{around, layout_dspic30f6014a().ports, pins};
    I2cMaster i2c{around, layout_dspic30f6014a().i2cs[0], clock, ports, pins};

    MasterBench() {
        write(sfr::I2CBRG, 150);
        write(sfr::I2CCON, kEnable);
    }
    void request(std::uint16_t bits) {
        write(sfr::I2CCON, static_cast<std::uint16_t>(read(sfr::I2CCON) | bits));
    }
    /// The ninth clock of the phase that is open ends.
    void answer(I2cPhaseKind kind, std::uint8_t byte, bool ack) {
        const I2cPhase& last = pins.phases.back();
        go(clock.first_cycle_at(last.start + 9 * last.clock_period));
        i2c.answer({.kind = kind, .byte = byte, .ack = static_cast<std::uint8_t>(ack ? 1 : 0)}, now);
    }
};

std::uint16_t bit_of(Activity activity) {
    WireMaster one;
    one.begin(activity);
    return one.control();
}

struct Seen {
    int transmitted = 0, received = 0, lost = 0, ignored = 0, overruns = 0, refused = 0, unacknowledged = 0;
};

/// What a program does next that owns the bus or not: what the module is made for, in any order.
Activity drawn(RandomStream& random, const WireMaster& wires) {
    if (!wires.mine()) return random.below(6) == 0 ? Activity::Stop : Activity::Start;
    const auto die = random.below(16);
    return die < 7    ? Activity::Transmit
           : die < 11 ? Activity::Receive
           : die < 13 ? Activity::Acknowledge
           : die < 14 ? Activity::Restart
                      : Activity::Stop;
}

class Comparison {
  public:
    Comparison(std::uint64_t seed, Seen& seen) : random_(seed, "master"), seen_(seen) {}

    void step() {
        const Activity activity = drawn(random_, wires_);
        const auto byte = static_cast<std::uint8_t>(random_.below(256));
        const std::size_t phases_before = chip_.pins.phases.size();
        begin(activity, byte);
        same();
        if (random_.below(4) == 0) interfere();
        const bool owned = chip_.pins.phases.size() > phases_before && activity != Activity::Stop;
        check_phases(activity, byte, phases_before);
        const auto others =
            static_cast<std::uint8_t>(activity == Activity::Receive ? random_.below(256)
                                      : random_.below(6) == 0       ? random_.below(256) | random_.below(256)
                                                                    : 0xFF);
        const bool low = random_.below(4) != 0;
        finish(activity, byte, others, low, owned);
        same();
        handle();
    }

  private:
    void begin(Activity activity, std::uint8_t byte) {
        if (activity == Activity::Transmit) {
            chip_.write(sfr::I2CTRN, byte);
            return wires_.write_transmit(byte);
        }
        const bool acknowledges = random_.below(2) == 0;
        if (activity == Activity::Acknowledge) {
            auto con = static_cast<std::uint16_t>(chip_.read(sfr::I2CCON) & ~kAckdt);
            if (!acknowledges) con |= kAckdt;
            chip_.write(sfr::I2CCON, con);
            if (received_) unacknowledged_ = !acknowledges;
        }
        chip_.request(bit_of(activity));
        wires_.begin(activity);
    }

    /// A second request while one is under way.
    void interfere() {
        if (random_.below(2) == 0) {
            chip_.write(sfr::I2CTRN, 0x55);
            wires_.write_transmit(0x55);
        } else {
            constexpr Activity kAll[] = {Activity::Start, Activity::Restart, Activity::Stop,
                                         Activity::Receive, Activity::Acknowledge};
            const Activity other = kAll[random_.below(5)];
            chip_.request(bit_of(other));
            wires_.begin(other);
        }
        ++seen_.ignored;
        same();
    }

    void check_phases(Activity activity, std::uint8_t byte, std::size_t before) {
        std::vector<I2cPhaseKind> kinds, expected;
        for (std::size_t i = before; i < chip_.pins.phases.size(); ++i)
            kinds.push_back(chip_.pins.phases[i].kind);
        const bool byte_follows =
            (activity == Activity::Transmit && !after_start_) || activity == Activity::Receive;
        if (byte_follows && unacknowledged_) {
            expected.push_back(I2cPhaseKind::Acknowledge);
            ++seen_.unacknowledged;
        }
        if (byte_follows) unacknowledged_ = received_ = false;
        if (activity == Activity::Transmit)
            expected.push_back(after_start_ ? I2cPhaseKind::Start : I2cPhaseKind::Write);
        if (activity == Activity::Receive) expected.push_back(I2cPhaseKind::Read);
        if (activity == Activity::Stop && wires_.mine()) expected.push_back(I2cPhaseKind::Stop);
        const bool same_phases = kinds == expected;
        CHECK(same_phases);
        if (activity == Activity::Transmit) CHECK(chip_.pins.phases.back().byte == byte);
    }

    void finish(Activity activity, std::uint8_t byte, std::uint8_t others, bool low, bool owned) {
        if (activity == Activity::Transmit) {
            const I2cPhase& open = chip_.pins.phases.back();
            chip_.go(chip_.clock.first_cycle_at(open.start + 17 * open.clock_period / 2));
            CHECK((chip_.read(sfr::I2CSTAT) & 0x4001) == 0x4000);  // TBF ends with the eighth clock
            const bool lost = (byte & ~others) != 0;
            chip_.answer(lost ? I2cPhaseKind::BusLost : I2cPhaseKind::Acknowledge, byte, low);
            after_start_ = false;
            ++seen_.transmitted;
            seen_.lost += lost;
            seen_.refused += !lost && !low;
        } else if (activity == Activity::Receive) {
            chip_.answer(I2cPhaseKind::Data, others, true);
            after_start_ = false;
            unacknowledged_ = received_ = true;
            ++seen_.received;
        } else {
            const Cycle end = chip_.now + kLong;
            while (chip_.events.next() < end)
                chip_.go(chip_.events.next());
        }
        CHECK((owned || activity != Activity::Transmit));
        wires_.finish(others, low);
        if (activity == Activity::Start || activity == Activity::Restart) {
            after_start_ = true;
            unacknowledged_ = received_ = false;
        }
    }

    /// Status, requests, interrupts; MI2CIF is fetched.
    void same() {
        interrupts_ += chip_.take(irq::MI2C);
        CHECK((chip_.read(sfr::I2CSTAT) & WireMaster::kCompared) == wires_.status());
        CHECK((chip_.read(sfr::I2CCON) & kRequests) == wires_.control());
        CHECK(interrupts_ == wires_.interrupts());
    }

    /// What a program does or forgets between two activities.
    void handle() {
        const bool overflows = wires_.status() & 0x40;
        seen_.overruns += overflows;
        if (random_.below(2) == 0) CHECK(chip_.read(sfr::I2CRCV) == wires_.read_receive());
        if (random_.below(2) != 0) return;
        chip_.write(sfr::I2CSTAT, 0);
        wires_.clear_sticky();
    }

    RandomStream random_;
    Seen& seen_;
    MasterBench chip_;
    WireMaster wires_;
    int interrupts_ = 0;
    bool after_start_ = false, received_ = false, unacknowledged_ = false;
};

constexpr int kSeeds = 60, kSteps = 400;

}  // namespace

TEST_CASE("dsPIC: a master under drawn programs, slaves and other masters, against the wires") {
    Seen seen;
    const auto drawn_seeds = static_cast<std::uint64_t>(seeds(kSeeds));
    for (std::uint64_t seed = 1; seed <= drawn_seeds; ++seed) {
        INFO("seed " << seed);
        Comparison comparison(seed, seen);
        for (int i = 0; i < kSteps; ++i) {
            INFO("step " << i);
            comparison.step();
        }
    }
    CHECK(seen.transmitted > 1000);
    CHECK(seen.received > 500);
    CHECK(seen.lost > 100);
    CHECK(seen.ignored > 1000);
    CHECK(seen.overruns > 100);
    CHECK(seen.refused > 100);
    CHECK(seen.unacknowledged > 100);
}
