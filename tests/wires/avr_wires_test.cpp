// The two-wire interface as a slave under masters that keep to nothing, against the wires (wire_twi.h): the
// line, the acknowledge, every status code and byte that its program sees, bus errors among them.

#include "tests/avr/rig.h"
#include "tests/wires/wire_twi.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::wires;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {

constexpr Time kPeriod = 100 * cosim::kMicrosecond;
constexpr int kLog = 0x200;

std::string program(const WireTwi::Setup& setup) {
    return fmt::format(R"(
        ldi r26, 0x00
        ldi r27, 0x02
        sts 0x0100, r26
        sts 0x0101, r27
        ldi r16, {}
        sts TWAR, r16
        ldi r16, {}
        sts TWAMR, r16
        ldi r24, 1
        ldi r25, 0
        ldi r20, 0x55       ; 25173
        ldi r21, 0x62
        ldi r16, 0xC4
        sts TWCR, r16
wait:   lds r17, TWCR
        sbrs r17, 7
        rjmp wait
        lds r17, TWSR
        st  X+, r17
        lds r18, TWDR
        st  X+, r18
        sts 0x0100, r26
        sts 0x0101, r27
        mul r24, r20
        mov r22, r0
        mov r23, r1
        mul r24, r21
        add r23, r0
        mul r25, r20
        add r23, r0
        mov r24, r22
        mov r25, r23
        ldi r18, 0x19       ; 13849
        add r24, r18
        ldi r18, 0x36
        adc r25, r18
        ldi r16, 0xC4
        cpi r17, 0x00
        brne nerror
        ldi r16, 0xD4
nerror: cpi r17, 0xA8
        breq load
        cpi r17, 0xB8
        breq load
        cpi r17, 0x60
        breq choose
        cpi r17, 0x70
        breq choose
        cpi r17, 0x80
        breq choose
        cpi r17, 0x90
        breq choose
        rjmp next
load:   mov r18, r24
        eor r18, r25
        sts TWDR, r18
        cpi r17, 0xB8
        brne next
choose: sbrc r25, 6
        rjmp leave
        sbrc r25, 4
        rjmp leave
        ldi r16, 0x84
leave:  sbrc r25, 2
        rjmp next
        sbrc r25, 3
        rjmp next
        ori r16, 0x10       ; TWSTO
next:   sts TWCR, r16
        rjmp wait
)",
                       setup.address | (setup.general_call ? 1 : 0), static_cast<int>(setup.mask));
}

class Slave {
  public:
    explicit Slave(const WireTwi::Setup& setup) : rig_(program(setup)) { rig_.chip.run_until(kPeriod); }

    /// Whether SDA is low in the next clock.
    bool first_bit_low() {
        rig_.answers.clear();
        const Time start = rig_.chip.now();
        rig_.chip.twi_slave_phase(first_bit_from(start, kPeriod));
        rig_.chip.run_until(start + 11 * kPeriod);
        REQUIRE(rig_.answers.size() == 1);
        CHECK(rig_.answers[0].kind == I2cPhaseKind::Acknowledge);
        return rig_.answers[0].ack != 0;
    }

    /// Returns the answer; none for a Stop and for a byte that is broken off.
    std::optional<I2cPhase> act(const Action& action) {
        const I2cPhase phase = phase_of(action, rig_.chip.now(), kPeriod);
        rig_.answers.clear();
        rig_.chip.twi_slave_phase(phase);
        if (action.kind == Action::Kind::Stop) {
            rig_.chip.run_until(phase.start + 2 * kPeriod);
            return {};
        }
        if (action.clocks < 9) {
            rig_.chip.run_until(phase.start + action.clocks * kPeriod + kPeriod / 2);
            return {};
        }
        rig_.chip.run_until(phase.start + 11 * kPeriod);
        REQUIRE(rig_.answers.size() == 1);
        return rig_.answers[0];
    }

    void compare(const std::vector<WireTwi::Service>& served) {
        const auto x =
            static_cast<std::size_t>(rig_.ram(std::uint16_t{0x100}) | rig_.ram(std::uint16_t{0x101}) << 8);
        REQUIRE((x - kLog) / 2 == served.size());
        for (; compared_ < served.size(); ++compared_) {
            const auto at = static_cast<std::uint16_t>(static_cast<std::size_t>(kLog) + 2 * compared_);
            INFO("service " << compared_);
            CHECK(rig_.ram(at) == served[compared_].status);
            if (served[compared_].data != 0)
                CHECK(rig_.ram(static_cast<std::uint16_t>(at + 1)) == served[compared_].data);
        }
    }

  private:
    avr::test::Rig rig_;
    std::size_t compared_ = 0;
};

constexpr int kSeeds = 240, kActions = 400;

}  // namespace

TEST_CASE("AVR: a two-wire slave under masters that keep to nothing, against the wires") {
    int both_sent = 0, broken = 0, behind_nack = 0, first_bits = 0, first_low = 0;
    std::map<int, int> statuses;
    const auto drawn_seeds = static_cast<std::uint64_t>(seeds(kSeeds));
    for (std::uint64_t seed = 1; seed <= drawn_seeds; ++seed) {
        INFO("seed " << seed);
        Draw choice(200 + seed, {});
        WireTwi::Setup setup;
        setup.address = 0x2A;
        setup.general_call = choice.one_in(2);
        if (choice.one_in(2)) setup.mask = 0x06;
        Slave chip(setup);
        WireTwi wires(setup);
        Draw draw(3000 + seed, {0x2A, 0x2A, 0x2A, 0x2C, 0x00});
        bool begun = false, sends = false, ended = false;
        for (int i = 0; i < kActions; ++i) {
            Action action = draw.action(begun);
            INFO("action " << i << " kind " << static_cast<int>(action.kind) << " byte " << int(action.byte)
                           << " clocks " << action.clocks);
            const bool condition = action.kind == Action::Kind::Start || action.kind == Action::Kind::Stop;
            if (condition && sends) {
                const bool low = !wires.lets_go();
                CHECK(chip.first_bit_low() == low);
                ++first_bits;
                first_low += low;
                if (low) {  // neither is possible: the master clocks on
                    action.kind = Action::Kind::Read;
                    action.ack = draw.one_in(2);
                    action.clocks = 9;
                }
            }
            sends = false;
            if (action.kind == Action::Kind::Start) wires.start();
            if (action.kind == Action::Kind::Stop) {
                wires.stop();
                chip.act(action);
                begun = ended = false;
                chip.compare(wires.served());
                continue;
            }
            begun = true;
            const std::uint8_t drives = action.kind == Action::Kind::Read ? 0xFF : action.byte;
            Action whole = action;
            whole.clocks = 9;
            for (int bit = 0; action.clocks < 9 && bit < action.clocks; ++bit)
                wires.clock(drives >> (7 - bit) & 1);
            if (action.clocks < 9 && wires.lets_go()) {
                chip.act(action);
                ++broken;
                ended = false;
                Action breaks;
                if (action.broken_by_stop) {
                    wires.stop();
                    chip.act(breaks);
                    begun = false;
                } else {
                    breaks.kind = Action::Kind::Start;
                    breaks.byte = draw.byte();
                    wires.start();
                    const Byte line = nine_clocks(wires, breaks.byte, false);
                    CHECK((chip.act(breaks)->ack != 0) == line.low);
                }
                chip.compare(wires.served());
                continue;
            }
            if (action.clocks < 9) {  // no START or STOP is possible against a low: the byte goes on
                for (int bit = action.clocks; bit < 8; ++bit)
                    wires.clock(drives >> (7 - bit) & 1);
                wires.clock(!(action.kind == Action::Kind::Read && action.ack));
                chip.act(whole);
            } else {
                const Byte line = nine_clocks(wires, drives, action.kind == Action::Kind::Read && action.ack);
                const auto answer = chip.act(whole);
                if (action.kind == Action::Kind::Read) {
                    CHECK(answer->byte == line.line);
                    behind_nack += ended;
                    ended = ended || !action.ack;
                } else {
                    CHECK((answer->ack != 0) == line.low);
                    both_sent += line.line != drives;
                    if (line.line != drives) CHECK(answer->byte == line.line);
                    if (action.kind == Action::Kind::Start) ended = false;
                }
            }
            sends = wires.sends();
            chip.compare(wires.served());
        }
        for (const auto& service : wires.served())
            ++statuses[service.status];
    }
    CHECK(both_sent > 20);
    CHECK(broken > 100);
    CHECK(behind_nack > 50);
    CHECK(first_bits > 500);
    CHECK(first_low > 200);
    for (const int status : {0x00, 0x60, 0x70, 0x80, 0x88, 0x90, 0x98, 0xA0, 0xA8, 0xB8, 0xC0, 0xC8}) {
        INFO("status " << status);
        CHECK(statuses[status] > 5);
    }
}
