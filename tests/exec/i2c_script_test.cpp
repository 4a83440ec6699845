// The bus master of the bench, against a slave that answers as it is set to.

#include "bench/i2c_script_master.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <deque>
#include <stdexcept>

using namespace puckloop;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::Time;

namespace {

class QuietListener : public exec::TargetListener {
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int, const I2cPhase&) override {}
    void i2c_answered(const I2cPhase&, Time) override {}
    void pin_changed(std::string_view, std::string_view, std::optional<bool>, Time) override {}
    void signal_changed(std::string_view, double, Time) override {}
};

/// A chip whose clock stands still, so that limit() has something to ask, and phases kept for the test.
class Slave : public exec::Target {
  public:
    Slave() : chip_(exec::make_bare_chip("dspic33fj256gp710", {}, listener_)) {}
    std::span<const cosim::SignalInfo> signals() const override { return {}; }
    void set_signal(std::uint16_t, double) override {}
    double signal(std::uint16_t) const override { return 0; }
    const image::LineTable& lines() const override { return chip_->lines(); }
    void load(const image::Image&) override {}
    void run_until(Time) override {}
    void uart_receive(int, const cosim::UartFrame&) override {}
    bool is_i2c_slave() const override { return true; }
    void i2c_slave_phase(const I2cPhase& phase) override { phases.push_back(phase); }
    Time earliest_i2c_answer() const override { return answer_at; }
    dspic::Chip& chip() override { return chip_->chip(); }

    std::deque<I2cPhase> phases;
    Time answer_at = cosim::kNever;

  private:
    QuietListener listener_;
    std::unique_ptr<exec::Target> chip_;
};

constexpr Time kClock = 10 * kMicrosecond;

/// Plays a script: `answer` fills in ack, byte and stretch of every phase but Stop.
template <typename Answer>
std::deque<I2cPhase> play(exec::I2cScriptMaster& master, Slave& slave, Answer answer) {
    while (master.due() != cosim::kNever) {
        master.begin();
        I2cPhase phase = slave.phases.back();
        if (phase.kind == I2cPhaseKind::Stop) continue;
        REQUIRE(master.due() == cosim::kNever);
        const std::size_t number = slave.phases.size();
        if (!answer(phase, number)) break;
        slave.answer_at = phase.start + 8 * kClock + phase.stretch;
        CHECK(master.limit() == slave.answer_at + kClock);
        master.answered(phase, slave.answer_at);
    }
    return slave.phases;
}

bool acknowledge(I2cPhase& phase, std::size_t) {
    phase.ack = 1;
    phase.byte = 0x5A;
    return true;
}

}  // namespace

TEST_CASE("a write and a read take the clocks that the bus gives them") {
    Slave slave;
    exec::I2cScriptMaster master(exec::parse_i2c_script("s", "0.001 w 0x20 0e 55\n0.002 r 0x20 7 2\n"), {},
                                 slave, nullptr);
    const auto phases = play(master, slave, acknowledge);
    REQUIRE(phases.size() == 4 + 6);
    const std::pair<I2cPhaseKind, Time> expected[] = {
        {I2cPhaseKind::Start, 0},        {I2cPhaseKind::Write, 9},       {I2cPhaseKind::Write, 18},
        {I2cPhaseKind::Stop, 27},        {I2cPhaseKind::Start, 100},     {I2cPhaseKind::Write, 109},
        {I2cPhaseKind::Start, 100 + 19}, {I2cPhaseKind::Read, 100 + 28}, {I2cPhaseKind::Read, 100 + 37},
        {I2cPhaseKind::Stop, 100 + 46}};
    for (std::size_t i = 0; i < phases.size(); ++i) {
        CHECK(phases[i].kind == expected[i].first);
        CHECK(phases[i].start == kMillisecond + expected[i].second * kClock);
    }
    CHECK(phases[0].byte == 0x40);
    CHECK(phases[6].byte == 0x41);
    CHECK(phases[7].ack == 1);
    CHECK(phases[8].ack == 0);  // the last byte wanted
    const exec::I2cScriptReport& report = master.report();
    CHECK(report.played == 2);
    CHECK(report.bytes_written == 3);
    REQUIRE(report.reads.size() == 1);
    CHECK(report.reads[0].bytes == std::vector<std::uint8_t>{0x5A, 0x5A});
    CHECK(report.reads[0].register_number == 7);
}

TEST_CASE("without repeated START a read stops and starts again") {
    Slave slave;
    exec::I2cScriptMaster master(exec::parse_i2c_script("s", "0 r 0x20 0 1\n"), {.repeated_start = false},
                                 slave, nullptr);
    const auto phases = play(master, slave, acknowledge);
    REQUIRE(phases.size() == 6);
    CHECK(phases[2].kind == I2cPhaseKind::Stop);
    CHECK(phases[3].kind == I2cPhaseKind::Start);
    CHECK(phases[3].start >= phases[2].start + 2 * kClock);
}

TEST_CASE("a read that names no register starts with the read") {
    Slave slave;
    exec::I2cScriptMaster master(exec::parse_i2c_script("s", "0 r 0x20 - 1\n"), {}, slave, nullptr);
    const auto phases = play(master, slave, acknowledge);
    REQUIRE(phases.size() == 3);
    CHECK(phases[0].byte == 0x41);
    CHECK(phases[1].kind == I2cPhaseKind::Read);
    CHECK_FALSE(master.report().reads[0].register_number.has_value());
}

TEST_CASE("a ten-bit address takes two bytes, a read of it three") {
    for (const bool repeated_start : {true, false}) {
        Slave slave;
        exec::I2cScriptMaster master(
            exec::parse_i2c_script("s", "0 w ten:0x2a5 0e\n0.01 r ten:0x2a5 7 1\n0.02 r ten:0x2a5 - 1\n"),
            {.repeated_start = repeated_start}, slave, nullptr);
        std::string wires;
        for (const I2cPhase& phase : play(master, slave, acknowledge)) {
            const char* kind = phase.kind == I2cPhaseKind::Start   ? "S"
                               : phase.kind == I2cPhaseKind::Write ? "w"
                               : phase.kind == I2cPhaseKind::Read  ? "r"
                                                                   : "P";
            wires += kind;
            if (*kind == 'S' || *kind == 'w') wires += fmt::format("{:02x}", phase.byte);
        }
        CHECK(wires == (repeated_start ? "Sf4wa5w0ePSf4wa5w07Sf5rPSf4wa5Sf5rP"
                                       : "Sf4wa5w0ePSf4wa5w07PSf4wa5Sf5rPSf4wa5Sf5rP"));
        CHECK(master.report().reads.back().address == 0x2A5);
    }
}

TEST_CASE("raw steps go on after a refusal and break off bytes") {
    Slave slave;
    exec::I2cScriptMaster master(
        exec::parse_i2c_script("s", "0 raw s3e w01/3 s3f r w0f n p\n0.01 w 0x20 01\n"), {}, slave, nullptr);
    std::size_t number = 0;
    std::vector<I2cPhase> seen;
    while (master.due() != cosim::kNever) {
        master.begin();
        seen.push_back(slave.phases.back());
        if (++number == 2 || seen.back().kind == I2cPhaseKind::Stop) continue;
        I2cPhase answer = seen.back();
        answer.ack = 0;
        if (answer.kind != I2cPhaseKind::Start) answer.byte = 0xA5;
        master.answered(answer, answer.start + 8 * kClock);
    }
    REQUIRE(seen.size() == 9);
    CHECK(seen[2].kind == I2cPhaseKind::Start);
    CHECK(seen[2].start == seen[1].start + 3 * kClock);
    CHECK(seen[3].ack == 1);
    CHECK(seen[5].ack == 0);
    CHECK(seen[6].kind == I2cPhaseKind::Stop);
    CHECK(master.report().bytes_read == 2);
    REQUIRE(master.report().reads.size() == 1);
    CHECK(master.report().reads[0].address == 0x1F);
    CHECK(master.report().reads[0].bytes == std::vector<std::uint8_t>{0xA5, 0xA5});
    CHECK(master.report().played == 2);
}

TEST_CASE("stretching delays what follows, a line that is late follows at once") {
    Slave slave;
    exec::I2cScriptMaster master(exec::parse_i2c_script("s", "0 w 0x20 0e 55\n0.0001 w 0x20 0e 55\n"), {},
                                 slave, nullptr);
    const auto phases = play(master, slave, [](I2cPhase& phase, std::size_t number) {
        phase.ack = 1;
        if (number == 3) phase.stretch = 808 * kMicrosecond;
        return true;
    });
    REQUIRE(phases.size() == 8);
    CHECK(phases[3].start == 27 * kClock + 808 * kMicrosecond);
    CHECK(phases[4].start == phases[3].start + 2 * kClock);
    CHECK(master.report().longest_stretch == 808 * kMicrosecond);
}

TEST_CASE("a byte that is not acknowledged ends the line, not the script") {
    Slave slave;
    exec::I2cScriptMaster master(
        exec::parse_i2c_script("s", "0 r 0x21 0 1\n0.001 w 0x20 01 02 03\n0.002 w 0x20 0e\n"), {}, slave,
        nullptr);
    const auto phases = play(master, slave, [](I2cPhase& phase, std::size_t number) {
        phase.ack = number == 1 || number == 4 ? 0 : 1;
        return true;
    });
    CHECK(phases.size() == 2 + 3 + 3);
    CHECK(master.report().addresses_refused == 1);
    CHECK(master.report().bytes_refused == 1);
    CHECK(master.report().first_refused == 1);
    CHECK(master.report().played == 3);
    CHECK(master.report().reads.empty());
}

TEST_CASE("a slave that holds SCL for ever ends the script and is named") {
    Slave slave;
    exec::I2cScriptMaster master(exec::parse_i2c_script("s", "# one\n0.001 r 0x20 0 1\n1 w 0x20 00 00\n"), {},
                                 slave, nullptr);
    play(master, slave, [](I2cPhase& phase, std::size_t number) {
        phase.ack = 1;
        return number < 3;
    });
    CHECK(master.due() == cosim::kNever);
    master.poll(50 * kMillisecond);
    CHECK_FALSE(master.report().stuck_since);
    master.poll(150 * kMillisecond);
    CHECK(master.report().stuck_since == kMillisecond + 19 * kClock);
    CHECK(master.report().stuck_line == 2);
    CHECK(master.due() == cosim::kNever);
    CHECK(master.limit() == cosim::kNever);
    CHECK(master.report().played == 0);
}

TEST_CASE("a STOP that the first bit of the slave's next byte prevents comes behind nine clocks") {
    for (const bool low : {false, true}) {
        INFO("first bit " << (low ? 0 : 1));
        Slave slave;
        exec::I2cScriptMaster master(exec::parse_i2c_script("s", "0 raw s3f r p\n0.01 w 0x20 01\n"), {},
                                     slave, nullptr);
        std::string wires;
        play(master, slave, [&](I2cPhase& phase, std::size_t) {
            // Behind the byte read: what is on SDA.
            phase.ack = phase.kind == I2cPhaseKind::Acknowledge ? (low ? 1 : 0) : phase.ack;
            if (phase.kind == I2cPhaseKind::Start || phase.kind == I2cPhaseKind::Write) phase.ack = 1;
            phase.byte = 0x5A;
            return true;
        });
        for (const I2cPhase& phase : slave.phases)
            wires += "SwrPa?"[static_cast<std::size_t>(phase.kind)] +
                     std::string(phase.kind == I2cPhaseKind::Read && phase.ack == 0 ? "-" : "");
        CHECK(wires == (low ? "Srar-PSwP" : "SraPSwP"));
        CHECK(master.report().bytes_read == 1);
        CHECK(master.report().reads.at(0).bytes == std::vector<std::uint8_t>{0x5A});
        CHECK(master.report().played == 2);
    }
}
