// The two-wire interface as master with drawn programs against drawn slaves and masters, against the wires
// (wire_twi_master.h): each status code with each operation that the data sheet lists for it, STOP and START
// where a slave is to send, which its first bit may prevent, STOP and START together, arbitration lost at any
// bit and in the ninth clock, TWDR written too early, bit rates.

#include "base/random.h"
#include "cosim/i2c/i2c_shared.h"
#include "tests/avr/rig.h"
#include "tests/wires/wire_slave.h"
#include "tests/wires/wire_twi_master.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <bit>
#include <map>

using namespace puckloop;
using namespace puckloop::wires;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {

using Wire = WireTwiMaster::Wire;

constexpr int kMasterLog = 0x300;

/// One operation of the program and what happens to it on the wires.
struct Operation {
    bool start = false, stop = false, acknowledges = false, early = false, meets_byte = false;
    std::uint8_t data = 0;
    Wire wire = Wire::None;
    std::uint8_t drives = 0xFF, others = 0xFF;
    bool low = false;
    // after it, as the program reads them
    int status = 0;
    std::uint8_t data_after = 0;
    bool interrupt = false, collision = false;
};

/// The operations that the tables list for this status.
void draw_request(Operation& operation, RandomStream& random, const WireTwiMaster& wires) {
    const auto die = random.below(16);
    const auto ends = [&] {
        operation.start = die % 3 != 0;
        operation.stop = die % 3 != 1;
    };
    switch (wires.status()) {
    case 0xF8:
        operation.start = true;
        break;
    case 0x38:  // START, or become a slave that nobody addresses
        operation.start = die < 12;
        break;
    case 0x08:
    case 0x10:
        operation.stop = die == 0;
        break;
    case 0x18:
    case 0x20:
    case 0x28:
    case 0x30:
        if (die < 6) ends();
        break;
    case 0x40:
    case 0x50:
        operation.acknowledges = die < 8;
        if (die > 12) ends();  // not listed
        break;
    default:  // 0x48, 0x58
        ends();
        break;
    }
}

/// `shared`: another master sends the same, and no slave's bit is in the way of both.
std::vector<Operation> drawn_program(RandomStream& random, int count, WireTwiMaster& wires, bool shared) {
    std::vector<Operation> program;
    while (static_cast<int>(program.size()) < count) {
        Operation one;
        draw_request(one, random, wires);
        one.data = static_cast<std::uint8_t>(random.below(256));
        wires.write_data(one.data);
        one.wire = wires.control(one.start, one.stop, one.acknowledges);
        one.drives = wires.data();
        const bool condition =
            one.wire == Wire::Start || one.wire == Wire::Stop || one.wire == Wire::StopAndStart;
        one.meets_byte = condition && wires.meets_byte() && !shared;
        if (one.wire == Wire::Read || one.meets_byte)
            one.others = static_cast<std::uint8_t>(random.below(256));
        else if (!condition && random.below(8) == 0)  // another master's bits
            one.others = static_cast<std::uint8_t>(random.below(256) | random.below(256));
        one.low = random.below(3) != 0;
        if (one.wire == Wire::Read && !one.acknowledges) one.low = random.below(4) == 0;
        // While an operation goes on TWDR is closed.
        one.early = one.wire != Wire::None && random.below(4) == 0;
        if (one.early) wires.write_data(static_cast<std::uint8_t>(~one.data));
        wires.finish(one.others, one.low);
        one.status = wires.status();
        one.data_after = wires.data();
        one.interrupt = wires.interrupt();
        one.collision = wires.write_collision();
        program.push_back(one);
    }
    return program;
}

std::string assembly_of(const std::vector<Operation>& program, int bit_rate, int prescaler) {
    std::string text = fmt::format(R"(
        ldi r26, 0x00
        ldi r27, 0x03
        ldi r16, {}
        sts TWBR, r16
        ldi r16, {}
        sts TWSR, r16
        ldi r20, 0
)",
                                   bit_rate, prescaler);
    for (std::size_t i = 0; i < program.size(); ++i) {
        const Operation& one = program[i];
        const int control =
            0x84 | (one.start ? 0x20 : 0) | (one.stop ? 0x10 : 0) | (one.acknowledges ? 0x40 : 0);
        text += fmt::format("        ldi r18, {}\n        sts TWDR, r18\n        ldi r16, {}\n"
                            "        sts TWCR, r16\n",
                            one.data, control);
        if (one.early) text += fmt::format("        ldi r18, {}\n        sts TWDR, r18\n", 255 - one.data);
        if (one.wire == Wire::Stop && one.status != 0x38)
            text += fmt::format("w{0}:    lds r17, TWCR\n        sbrc r17, 4\n        rjmp w{0}\n", i);
        else if (one.wire != Wire::None)
            text += fmt::format("w{0}:    lds r17, TWCR\n        sbrs r17, 7\n        rjmp w{0}\n", i);
        text += "        lds r17, TWCR\n        andi r17, 0x88\n        st X+, r17\n        lds r17, TWSR\n"
                "        andi r17, 0xF8\n        st X+, r17\n        lds r17, TWDR\n        st X+, r17\n"
                "        inc r20\n        sts 0x0200, r20\n";
    }
    return text + "over:   rjmp over\n";
}

class MasterOnWires {
  public:
    MasterOnWires(const std::vector<Operation>& program, int bit_rate, int prescaler, bool shared)
        : program_(program), rig_(assembly_of(program, bit_rate, prescaler)), shared_(shared) {
        const Time cycle = rig_.chip.clock().time_of(1000) / 1000;
        period_ = cycle * (16 + 2 * bit_rate * (1 << (2 * prescaler)));
    }

    void run() {
        for (std::size_t i = 0; i < program_.size(); ++i) {
            INFO("operation " << i << " wire " << static_cast<int>(program_[i].wire) << " status "
                              << program_[i].status);
            until_done(i);
            const auto at = static_cast<std::uint16_t>(kMasterLog + 3 * static_cast<int>(i));
            const Operation& one = program_[i];
            CHECK(rig_.ram(at) == ((one.interrupt ? 0x80 : 0) | (one.collision ? 0x08 : 0)));
            CHECK(rig_.ram(static_cast<std::uint16_t>(at + 1)) == one.status);
            CHECK(rig_.ram(static_cast<std::uint16_t>(at + 2)) == one.data_after);
        }
        CHECK(rig_.phases.size() == seen_);
    }

  private:
    /// Serves what the program does until it has done operation `i`.
    void until_done(std::size_t i) {
        const Operation& one = program_[i];
        std::size_t served = 0;
        for (int step = 0; step < 4000 && rig_.ram(std::uint16_t{0x200}) != static_cast<std::uint8_t>(i + 1);
             ++step) {
            // Less than the program needs from the count to the next operation.
            rig_.chip.run_until(rig_.chip.now() + cosim::kMicrosecond / 5);
            for (; seen_ < rig_.phases.size(); ++served)
                serve(one, rig_.phases[seen_++]);
        }
        REQUIRE(rig_.ram(std::uint16_t{0x200}) == static_cast<std::uint8_t>(i + 1));
        const bool own = one.wire != Wire::None && one.wire != Wire::Start;
        const bool stops = one.status != 0x38 && (one.wire == Wire::Stop || one.wire == Wire::StopAndStart);
        CHECK(served == (one.meets_byte ? 1u + (stops ? 1u : 0u) : own ? 1u : 0u));
    }

    void serve(const Operation& one, I2cPhase phase) {
        CHECK(std::abs(phase.clock_period - period_) <= 1000);
        I2cPhase answer = phase;
        Time clocks = 9;
        const bool lost_bit = (one.drives & ~one.others) != 0;
        if (phase.kind == I2cPhaseKind::Acknowledge) {
            CHECK(one.meets_byte);
            answer.kind = one.status == 0x38 ? I2cPhaseKind::BusLost : I2cPhaseKind::Acknowledge;
            answer.ack = 0;
            rig_.chip.run_until(phase.start + clocks * phase.clock_period);
            if (answer.kind == I2cPhaseKind::BusLost) told_ = false;
            return rig_.chip.twi_answer(answer);
        }
        switch (one.wire) {
        case Wire::Address:
        case Wire::Write:
            CHECK(phase.kind == (one.wire == Wire::Address ? I2cPhaseKind::Start : I2cPhaseKind::Write));
            CHECK(phase.byte == one.drives);
            answer.kind = lost_bit ? I2cPhaseKind::BusLost : I2cPhaseKind::Acknowledge;
            answer.ack = one.low ? 1 : 0;
            if (!lost_bit) break;
            clocks = std::countl_zero(static_cast<std::uint8_t>(one.drives & ~one.others)) + 1;
            answer.byte = one.data_after;
            break;
        case Wire::Read:
            CHECK(phase.kind == I2cPhaseKind::Read);
            CHECK(phase.ack == (one.acknowledges ? 1 : 0));
            answer.kind = one.status == 0x38 ? I2cPhaseKind::BusLost : I2cPhaseKind::Data;
            answer.byte = one.others;
            break;
        default:
            CHECK(phase.kind == I2cPhaseKind::Stop);
            if (!told_) return;
            told_ = false;
            answer.kind = I2cPhaseKind::Acknowledge;
            clocks = 1;
            break;
        }
        const Time ends = phase.start + clocks * phase.clock_period;
        rig_.chip.run_until(ends);
        if (answer.kind == I2cPhaseKind::BusLost) told_ = false;
        if (shared_ && one.wire == Wire::Address && answer.kind == I2cPhaseKind::Acknowledge) {
            I2cPhase notice = phase;
            notice.kind = cosim::kSharedNotice;
            rig_.chip.twi_answer(notice);
            told_ = true;
        }
        rig_.chip.twi_answer(answer);
    }

    const std::vector<Operation>& program_;
    avr::test::Rig rig_;
    bool shared_, told_ = false;
    Time period_ = 0;
    std::size_t seen_ = 0;
};

constexpr int kTwiMasterSeeds = 40, kOperations = 200;

}  // namespace

TEST_CASE("AVR: a two-wire master under drawn programs, slaves and other masters, against the wires") {
    std::map<int, int> statuses;
    int operations = 0, collisions = 0, stop_and_start = 0, met = 0, prevented = 0;
    const auto drawn_seeds = static_cast<std::uint64_t>(seeds(kTwiMasterSeeds));
    for (std::uint64_t seed = 1; seed <= drawn_seeds; ++seed) {
        INFO("seed " << seed);
        RandomStream random(seed, "twi master");
        const int prescaler = static_cast<int>(random.below(3));
        const int bit_rate = static_cast<int>(random.below(prescaler == 0 ? 40 : 8));
        WireTwiMaster wires;
        const bool shared = random.below(2) == 0;
        const std::vector<Operation> program = drawn_program(random, kOperations, wires, shared);
        MasterOnWires(program, bit_rate, prescaler, shared).run();
        operations += static_cast<int>(program.size());
        for (const Operation& one : program) {
            ++statuses[one.status];
            collisions += one.collision;
            met += one.meets_byte;
            prevented += one.meets_byte && one.status == 0x38;
            stop_and_start += one.wire == Wire::StopAndStart;
        }
    }
    CHECK(operations == seeds(kTwiMasterSeeds) * kOperations);
    CHECK(collisions > 10 * seeds(kTwiMasterSeeds));
    CHECK(stop_and_start > seeds(kTwiMasterSeeds));
    CHECK(met > 2 * seeds(kTwiMasterSeeds));
    CHECK(prevented > seeds(kTwiMasterSeeds) / 2);
    for (const int status : {0x08, 0x10, 0x18, 0x20, 0x28, 0x30, 0x38, 0x40, 0x48, 0x50, 0x58, 0xF8}) {
        INFO("status " << status);
        CHECK(statuses[status] > 10);
    }
}
