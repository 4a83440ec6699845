// The master of a dsPIC's I2C module with drawn actions of its program against drawn slaves and masters,
// against the wires (wire_master.h): requests while another is under way, bytes that nobody fetched, bytes
// refused, arbitration lost at any bit, what follows a byte that was not acknowledged, a START while another
// master has the bus, bytes received right behind a START, SCL held low by others, the ninth clock and the
// STOP of a bus that another master shares.

#include "base/random.h"
#include "cosim/i2c/i2c_shared.h"
#include "emu/dspic/peripherals/i2c_master.h"
#include "emu/dspic/peripherals/i2c_slave.h"
#include "tests/dspic/peripheral_bench.h"
#include "tests/wires/wire_master.h"
#include "tests/wires/wire_slave.h"

#include <catch2/catch.hpp>

#include <bit>

using namespace puckloop;
using namespace puckloop::wires;
using namespace puckloop::dspic;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;

namespace {

using Activity = WireMaster::Activity;

constexpr std::uint16_t kModuleOn = 0x8000;
constexpr std::uint16_t kRequests = 0x1F, kAckdt = 0x20;
constexpr Cycle kSettled = 100'000;

struct MasterBench : dspic::test::Bench {
    Ports ports{around, layout_dspic30f6014a().ports, pins};
    I2cMaster i2c{around, layout_dspic30f6014a().i2cs[0], clock, ports, pins};
    I2cSlave slave{around, layout_dspic30f6014a().i2cs[0], clock, pins};

    MasterBench() {
        i2c.attach(slave);
        write(sfr::I2CBRG, 150);
        write(sfr::I2CCON, kModuleOn);
    }
    void request(std::uint16_t bits) {
        write(sfr::I2CCON, static_cast<std::uint16_t>(read(sfr::I2CCON) | bits));
    }
    /// Another master's transfer with another device.
    void other(I2cPhaseKind kind) {
        I2cPhase phase;
        phase.kind = kind;
        phase.byte = 0x54;
        phase.start = clock.time_of(now);
        phase.clock_period = 10 * cosim::kMicrosecond;
        slave.phase(phase, now);
        go(now + kSettled / 10);
    }
    /// So many half clocks of the phase that is open are over.
    void go_half_clocks(int count) {
        const I2cPhase& last = pins.phases.back();
        go(clock.first_cycle_at(last.start + count * last.clock_period / 2));
    }
    /// Its ninth clock ends, or the one in which a bit was lost.
    void answer(I2cPhaseKind kind, std::uint8_t byte, bool ack, int clocks = 9, Cycle stretch = 0) {
        go_half_clocks(2 * clocks);
        if (stretch > 0) {
            const std::uint16_t status = read(sfr::I2CSTAT), control = read(sfr::I2CCON);
            go(now + stretch);
            CHECK(read(sfr::I2CSTAT) == status);
            CHECK(read(sfr::I2CCON) == control);
        }
        i2c.answer({.kind = kind, .byte = byte, .ack = static_cast<std::uint8_t>(ack ? 1 : 0)}, now);
    }
};

std::uint16_t bit_of(Activity activity) {
    WireMaster one;
    one.begin(activity);
    return one.control();
}

struct MasterSeen {
    int steps = 0, transmitted = 0, received = 0, lost = 0, ignored = 0, overruns = 0, refused = 0,
        unacknowledged = 0, taken = 0, behind_start = 0, stretched = 0, lost_ninth = 0, lost_stop = 0;
};

/// What a program does next that owns the bus or not: what the module is made for, in any order.
Activity drawn_activity(RandomStream& random, const WireMaster& wires) {
    if (!wires.mine()) return !wires.taken() && random.below(6) == 0 ? Activity::Stop : Activity::Start;
    const auto die = random.below(16);
    return die < 7    ? Activity::Transmit
           : die < 11 ? Activity::Receive
           : die < 13 ? Activity::Acknowledge
           : die < 14 ? Activity::Restart
                      : Activity::Stop;
}

class Comparison {
  public:
    Comparison(std::uint64_t seed, MasterSeen& seen) : random_(seed, "master"), seen_(seen) {}

    void step() {
        ++seen_.steps;
        if (!wires_.mine() && random_.below(4) == 0) return other_master();
        const Activity activity = drawn_activity(random_, wires_);
        auto byte = static_cast<std::uint8_t>(random_.below(256));
        // A 0 would be the ninth clock that was left out (tests/exec/i2c_ninth_clock_test.cpp).
        if (activity == Activity::Transmit && ninth_open_) byte |= 0x80;
        const std::size_t phases_before = chip_.pins.phases.size();
        begin(activity, byte);
        same();
        if (wires_.idle()) {  // a collision at once
            CHECK(chip_.pins.phases.size() == phases_before);
            ++seen_.taken;
            return handle();
        }
        if (random_.below(4) == 0) interfere();
        const bool owned = chip_.pins.phases.size() > phases_before && activity != Activity::Stop;
        check_phases(activity, byte, phases_before);
        const bool any = activity == Activity::Receive || activity == Activity::Stop;
        const auto others =
            static_cast<std::uint8_t>(any                     ? random_.below(256)
                                      : random_.below(6) == 0 ? random_.below(256) | random_.below(256)
                                                              : 0xFF);
        // What comes after a byte meets others only while another master shares the bus.
        const bool alone = activity == Activity::Acknowledge || activity == Activity::Stop;
        const bool low = alone && !shared_ ? false : random_.below(4) != 0;
        finish(activity, byte, alone && !shared_ ? std::uint8_t{0xFF} : others, low, owned);
        ninth_open_ = activity == Activity::Receive;
        same();
        handle();
    }

  private:
    void other_master() {
        if (wires_.taken()) {
            chip_.other(I2cPhaseKind::Stop);
            wires_.other_stops();
        } else {
            chip_.other(I2cPhaseKind::Start);
            wires_.other_starts();
        }
        same();
    }
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
            (activity == Activity::Transmit || activity == Activity::Receive) && !after_start_;
        if (byte_follows && unacknowledged_ && !shared_) {
            expected.push_back(I2cPhaseKind::Acknowledge);
            ++seen_.unacknowledged;
        }
        if (byte_follows) unacknowledged_ = received_ = false;
        if (activity == Activity::Transmit)
            expected.push_back(after_start_ ? I2cPhaseKind::Start : I2cPhaseKind::Write);
        // Eight ones that follow a START are an address byte for all who listen.
        if (activity == Activity::Receive)
            expected.push_back(after_start_ ? I2cPhaseKind::Start : I2cPhaseKind::Read);
        if (activity == Activity::Acknowledge && shared_) expected.push_back(I2cPhaseKind::Acknowledge);
        if (activity == Activity::Stop && wires_.mine()) expected.push_back(I2cPhaseKind::Stop);
        const bool same_phases = kinds == expected;
        CHECK(same_phases);
        if (activity == Activity::Transmit) CHECK(chip_.pins.phases.back().byte == byte);
        if (activity == Activity::Acknowledge && shared_)
            CHECK(chip_.pins.phases.back().ack == (chip_.read(sfr::I2CCON) & kAckdt ? 0 : 1));
        if (activity == Activity::Receive && !after_start_)
            CHECK(chip_.pins.phases.back().ack == (shared_ ? cosim::kAcknowledgedLater : 1));
        if (activity == Activity::Receive && after_start_) {
            CHECK(chip_.pins.phases.back().byte == 0xFF);
            ++seen_.behind_start;
        }
    }

    void finish(Activity activity, std::uint8_t byte, std::uint8_t others, bool low, bool owned) {
        if (activity == Activity::Transmit) {
            const auto wrong = static_cast<std::uint8_t>(byte & ~others);
            const bool lost = wrong != 0;
            const int clocks = lost ? std::countl_zero(wrong) + 1 : 9;
            if (clocks > 7) {
                chip_.go_half_clocks(15);
                CHECK((chip_.read(sfr::I2CSTAT) & 0x4001) == 0x4001);
            }
            if (clocks > 8) {  // TBF ends with the eighth clock
                chip_.go_half_clocks(17);
                CHECK((chip_.read(sfr::I2CSTAT) & 0x4001) == 0x4000);
            }
            // Another master may have sent the same address.
            if (!lost && after_start_ && random_.below(3) == 0) {
                chip_.answer(cosim::kSharedNotice, byte, false);
                shared_ = true;
            }
            chip_.answer(lost ? I2cPhaseKind::BusLost : I2cPhaseKind::Acknowledge, byte, low, clocks,
                         lost ? 0 : stretch());
            if (lost) shared_ = false;
            after_start_ = false;
            ++seen_.transmitted;
            seen_.lost += lost;
            seen_.refused += !lost && !low;
        } else if (activity == Activity::Receive) {
            chip_.answer(I2cPhaseKind::Data, others, true, 9, stretch());
            after_start_ = false;
            unacknowledged_ = received_ = true;
            ++seen_.received;
        } else if (shared_ && (activity == Activity::Acknowledge || activity == Activity::Stop)) {
            const bool high = activity == Activity::Stop || (chip_.read(sfr::I2CCON) & kAckdt) != 0;
            const bool pulled = activity == Activity::Stop ? (others & 0x80) == 0 : low;
            chip_.answer(high && pulled ? I2cPhaseKind::BusLost : I2cPhaseKind::Acknowledge, 0, low, 1,
                         stretch());
            if (activity == Activity::Stop || (high && pulled)) shared_ = false;
            seen_.lost_stop += activity == Activity::Stop && pulled;
            seen_.lost_ninth += activity == Activity::Acknowledge && high && pulled;
        } else {
            const Cycle end = chip_.now + kSettled;
            while (chip_.events.next() < end)
                chip_.go(chip_.events.next());
        }
        CHECK((owned || activity != Activity::Transmit));
        wires_.finish(others, low, (chip_.read(sfr::I2CCON) & kAckdt) != 0);
        if (activity == Activity::Start || activity == Activity::Restart) {
            after_start_ = true;
            unacknowledged_ = received_ = false;
        }
    }

    /// A slave, or another master, holds SCL low for so many cycles: until then nothing has ended.
    Cycle stretch() {
        if (random_.below(4) != 0) return 0;
        ++seen_.stretched;
        return static_cast<Cycle>(1 + random_.below(2000));
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
    MasterSeen& seen_;
    MasterBench chip_;
    WireMaster wires_;
    int interrupts_ = 0;
    bool after_start_ = false, received_ = false, unacknowledged_ = false, shared_ = false;
    bool ninth_open_ = false;  ///< of the byte received newest
};

constexpr int kDspicMasterSeeds = 60, kDspicMasterSteps = 400;

}  // namespace

TEST_CASE("dsPIC: a master under drawn programs, slaves and other masters, against the wires") {
    MasterSeen seen;
    const auto drawn_seeds = static_cast<std::uint64_t>(seeds(kDspicMasterSeeds));
    for (std::uint64_t seed = 1; seed <= drawn_seeds; ++seed) {
        INFO("seed " << seed);
        Comparison comparison(seed, seen);
        for (int i = 0; i < kDspicMasterSteps; ++i) {
            INFO("step " << i);
            comparison.step();
        }
    }
    CHECK(seen.steps == seeds(kDspicMasterSeeds) * kDspicMasterSteps);
    CHECK(seen.taken > 5 * seeds(kDspicMasterSeeds));
    CHECK(seen.behind_start > seeds(kDspicMasterSeeds));
    CHECK(seen.stretched > 10 * seeds(kDspicMasterSeeds));
    CHECK(seen.lost_ninth > seeds(kDspicMasterSeeds) / 4);
    CHECK(seen.lost_stop > seeds(kDspicMasterSeeds) / 4);
    CHECK(seen.transmitted > 1000);
    CHECK(seen.received > 500);
    CHECK(seen.lost > 100);
    CHECK(seen.ignored > 1000);
    CHECK(seen.overruns > 100);
    CHECK(seen.refused > 100);
    CHECK(seen.unacknowledged > 100);
}
