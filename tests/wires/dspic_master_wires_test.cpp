// The master of a dsPIC's I2C module with drawn actions of its program against drawn slaves and masters,
// against the wires (wire_master.h): requests while another is under way, bytes that nobody fetched, bytes
// refused, arbitration lost at any bit, what follows a byte that was not acknowledged, a START while another
// master has the bus, bytes received right behind a START, SCL held low by others, the ninth clock and the
// STOP of a bus that another master shares, ninth clocks left out or given too often in any number, STOP and
// START against the first bit of a slave that is to send.

#include "base/random.h"
#include "cosim/i2c/i2c_shared.h"
#include "emu/dspic/peripherals/serial/i2c_master.h"
#include "emu/dspic/peripherals/serial/i2c_slave.h"
#include "tests/dspic/peripherals/peripheral_bench.h"
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
    void answer(I2cPhaseKind kind, std::uint8_t byte, std::uint8_t ack, int clocks = 9, Cycle stretch = 0) {
        go_half_clocks(2 * clocks);
        if (stretch > 0) {
            const std::uint16_t status = read(sfr::I2CSTAT), control = read(sfr::I2CCON);
            go(now + stretch);
            CHECK(read(sfr::I2CSTAT) == status);
            CHECK(read(sfr::I2CCON) == control);
        }
        i2c.answer({.kind = kind, .byte = byte, .ack = ack}, now);
    }
};

std::uint16_t bit_of(Activity activity) {
    WireMaster one;
    one.begin(activity);
    return one.control();
}

struct MasterSeen {
    int steps = 0, transmitted = 0, received = 0, lost = 0, ignored = 0, overruns = 0, refused = 0,
        unacknowledged = 0, taken = 0, behind_start = 0, stretched = 0, lost_ninth = 0, lost_stop = 0,
        loose = 0, far_loose = 0, first_bits = 0, first_low = 0, behind_ninth = 0, held = 0;
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
        const auto byte = static_cast<std::uint8_t>(random_.below(256));
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
        auto others =
            static_cast<std::uint8_t>(any                     ? random_.below(256)
                                      : random_.below(6) == 0 ? random_.below(256) | random_.below(256)
                                                              : 0xFF);
        bool low = random_.below(4) != 0;
        // What comes after a byte meets others only while another master shares the bus, and slaves that
        // acknowledge or send.
        const bool condition = is_condition(activity);
        if (condition && (!shared_ || activity != Activity::Stop))
            others = static_cast<std::uint8_t>(meets_first_bit(activity) ? random_.below(256)
                                               : held_ && !shared_       ? 0x7F
                                                                         : 0xFF);
        if (activity == Activity::Acknowledge && !shared_ && !loose_) low = held_;
        finish(activity, byte, others, low, owned);
        same();
        handle();
    }

  private:
    static bool is_condition(Activity activity) {
        return activity == Activity::Start || activity == Activity::Restart || activity == Activity::Stop;
    }
    bool meets_first_bit(Activity activity) const {
        return is_condition(activity) && heard_ && reads_ && place_ == 0 && !shared_ && had_bus_;
    }

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

    /// What the slaves' byte has had of its nine clocks decides what the bus is to know.
    bool check_loose(Activity activity, std::uint8_t byte, std::size_t before) {
        const bool clocks = activity == Activity::Transmit || activity == Activity::Receive ||
                            activity == Activity::Acknowledge;
        const int due = activity == Activity::Acknowledge ? 8 : 0;
        loose_ = clocks && heard_ && !reads_ && !shared_ && !after_start_ && place_ != due;
        if (!loose_) return false;
        ++seen_.loose;
        seen_.far_loose += place_ > 0 && place_ < 8;
        unacknowledged_ = received_ = false;
        REQUIRE(chip_.pins.phases.size() == before + 1);
        const I2cPhase& phase = chip_.pins.phases.back();
        CHECK(phase.kind == I2cPhaseKind::Data);
        const auto sent = cosim::LooseClocks::of(phase.ack);
        CHECK(sent.before == place_);
        CHECK(sent.count == (activity == Activity::Transmit ? 9 : activity == Activity::Receive ? 8 : 1));
        const bool refuses = (chip_.read(sfr::I2CCON) & kAckdt) != 0;
        CHECK((phase.byte & 0x80) == ((activity == Activity::Transmit             ? byte
                                       : activity == Activity::Receive || refuses ? 0xFF
                                                                                  : 0) &
                                      0x80));
        if (activity == Activity::Transmit) CHECK(phase.byte == byte);
        return true;
    }

    void check_phases(Activity activity, std::uint8_t byte, std::size_t before) {
        if (check_loose(activity, byte, before)) return;
        std::vector<I2cPhaseKind> kinds, expected;
        for (std::size_t i = before; i < chip_.pins.phases.size(); ++i)
            kinds.push_back(chip_.pins.phases[i].kind);
        const bool byte_follows =
            (activity == Activity::Transmit || activity == Activity::Receive) && !after_start_;
        const bool behind_ninth = activity == Activity::Transmit && heard_ && reads_ && place_ == 8 &&
                                  !shared_ && !after_start_ && byte < 0x80;
        seen_.behind_ninth += behind_ninth;
        if (byte_follows && unacknowledged_ && !shared_ && !behind_ninth) {
            expected.push_back(I2cPhaseKind::Acknowledge);
            ++seen_.unacknowledged;
        }
        if (byte_follows) unacknowledged_ = received_ = behind_ninth;
        if (activity == Activity::Transmit)
            expected.push_back(after_start_ ? I2cPhaseKind::Start : I2cPhaseKind::Write);
        // Eight ones that follow a START are an address byte for all who listen.
        if (activity == Activity::Receive)
            expected.push_back(after_start_ ? I2cPhaseKind::Start : I2cPhaseKind::Read);
        if (activity == Activity::Acknowledge && shared_) expected.push_back(I2cPhaseKind::Acknowledge);
        had_bus_ = wires_.mine();
        if (meets_first_bit(activity))
            expected.push_back(I2cPhaseKind::Acknowledge);
        else if (activity == Activity::Stop && had_bus_ && !held_)
            expected.push_back(I2cPhaseKind::Stop);
        const bool same_phases = kinds == expected;
        CHECK(same_phases);
        if (activity == Activity::Transmit)
            CHECK(chip_.pins.phases.back().byte == (behind_ninth ? (byte << 1 & 0xFF) + 1 : byte));
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
            finish_transmit(byte, others, low);
        } else if (activity == Activity::Receive) {
            held_ = (loose_ || !reads_) && !shared_ && heard_ && after_byte(8) == 8 && random_.below(2) == 0;
            const std::uint8_t ack = loose_  ? held_ ? cosim::LooseClocks::kHeldLow : std::uint8_t{0}
                                      : held_ ? cosim::kDeviceAcknowledges
                                             : std::uint8_t{1};
            chip_.answer(I2cPhaseKind::Data, others, ack, 9, stretch());
            if (!loose_) unacknowledged_ = received_ = true;
            heard_ = heard_ && !(reads_ && place_ == 8 && !shared_) && !after_start_;
            after_start_ = false;
            place_ = loose_ ? after_byte(8) : 8;
            ++seen_.received;
        } else if (activity == Activity::Acknowledge && loose_) {
            finish_loose_acknowledge(low);
        } else if (meets_first_bit(activity)) {
            const bool pulled = (others & 0x80) == 0;
            chip_.answer(pulled ? I2cPhaseKind::BusLost : I2cPhaseKind::Acknowledge, 0, 0, 9, stretch());
            ++seen_.first_bits;
            seen_.first_low += pulled;
            run_on();
        } else if (shared_ && (activity == Activity::Acknowledge || activity == Activity::Stop)) {
            const bool high = activity == Activity::Stop || (chip_.read(sfr::I2CCON) & kAckdt) != 0;
            const bool pulled = activity == Activity::Stop ? (others & 0x80) == 0 : low;
            chip_.answer(high && pulled ? I2cPhaseKind::BusLost : I2cPhaseKind::Acknowledge, 0, low ? 1 : 0,
                         1, stretch());
            if (activity == Activity::Stop || (high && pulled)) shared_ = false;
            seen_.lost_stop += activity == Activity::Stop && pulled;
            seen_.lost_ninth += activity == Activity::Acknowledge && high && pulled;
        } else {
            seen_.held += held_;
            run_on();
        }
        CHECK((owned || activity != Activity::Transmit));
        const bool refuses = (chip_.read(sfr::I2CCON) & kAckdt) != 0;
        wires_.finish(others, low, refuses);
        if (activity == Activity::Acknowledge && !loose_) {
            if (reads_ && refuses && place_ == 8 && !shared_) heard_ = false;
            place_ = 0;
            held_ = false;
        }
        if (is_condition(activity)) {
            after_start_ = activity != Activity::Stop && wires_.mine();
            unacknowledged_ = received_ = heard_ = held_ = false;
        }
        if (!wires_.mine()) heard_ = held_ = false;
        loose_ = false;
    }

    void finish_transmit(std::uint8_t byte, std::uint8_t others, bool low) {
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
            chip_.answer(cosim::kSharedNotice, byte, 0);
            shared_ = true;
        }
        held_ = loose_ && place_ == 8 && random_.below(2) == 0;
        const std::uint8_t flags =
            (low ? cosim::LooseClocks::kLineLow : 0) | (held_ ? cosim::LooseClocks::kHeldLow : 0);
        const std::uint8_t ack = loose_ ? flags : low ? 1 : 0;
        chip_.answer(lost     ? I2cPhaseKind::BusLost
                     : loose_ ? I2cPhaseKind::Data
                              : I2cPhaseKind::Acknowledge,
                     byte, ack, clocks, lost ? 0 : stretch());
        if (lost) shared_ = false;
        if (after_start_) {
            heard_ = low && !lost;
            reads_ = (byte & 1) != 0;
            place_ = 0;
        } else if (!loose_ && reads_ && !(place_ == 8 && byte < 0x80)) {
            heard_ = false;  // the slave's byte is not acknowledged
        }
        after_start_ = false;
        ++seen_.transmitted;
        seen_.lost += lost;
        seen_.refused += !lost && !low;
    }

    void finish_loose_acknowledge(bool& low) {
        const bool refuses = (chip_.read(sfr::I2CCON) & kAckdt) != 0;
        const bool ninth = place_ == 8;
        low = ninth && held_;
        place_ = after_byte(1);
        held_ = place_ == 8 && random_.below(2) == 0;
        if (place_ < 8 && !ninth) {
            run_on();
        } else {
            const bool lost = refuses && low;
            chip_.answer(lost ? I2cPhaseKind::BusLost : I2cPhaseKind::Data, 0,
                         held_ ? cosim::LooseClocks::kHeldLow : 0, 9, stretch());
        }
    }

    int after_byte(int clocks) const { return (place_ + clocks) % 9; }
    void run_on() {
        const Cycle end = chip_.now + kSettled;
        while (chip_.events.next() < end)
            chip_.go(chip_.events.next());
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
    bool heard_ = false, reads_ = false;  ///< a slave is there, and sends
    bool held_ = false;                   ///< it acknowledges in the clock that comes
    bool loose_ = false, had_bus_ = false;
    int place_ = 0;  ///< clocks that the slave's byte has had
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
    CHECK(seen.loose > 100);
    CHECK(seen.far_loose > 50);
    CHECK(seen.first_bits > 50);
    CHECK(seen.first_low > 20);
    CHECK(seen.behind_ninth > 10);
    CHECK(seen.held > 20);
}
