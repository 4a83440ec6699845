// Which frames became messages: from register traffic and what was on the air.

#include "base/random.h"
#include "tests/kit/scratch.h"
#include "traces/rab_losses/results.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tools;

namespace {

constexpr Time kPeriod = 10 * kMicrosecond;

/// Phases between a bus and its board, as a trace records them.
class Wire {
  public:
    void say(I2cPhaseKind kind, std::uint8_t byte) {
        begun_ = now_;
        row({.kind = kind, .byte = byte, .start = begun_, .clock_period = kPeriod});
    }
    void answer(I2cPhaseKind kind, std::uint8_t byte, bool ack, Time stretch = 0) {
        now_ = begun_ + 8 * kPeriod + stretch;
        row({.kind = kind,
             .byte = byte,
             .ack = ack,
             .start = begun_,
             .clock_period = kPeriod,
             .stretch = stretch});
        now_ += kPeriod;
    }
    void write(Time at, std::uint8_t number, std::uint8_t value, Time stretch = 0) {
        now_ = at;
        say(I2cPhaseKind::Start, 0x40);
        answer(I2cPhaseKind::Acknowledge, 0, true);
        say(I2cPhaseKind::Write, number);
        answer(I2cPhaseKind::Acknowledge, 0, true);
        say(I2cPhaseKind::Write, value);
        answer(I2cPhaseKind::Acknowledge, 0, true, stretch);
        say(I2cPhaseKind::Stop, 0);
    }
    void read(Time at, std::uint8_t number, std::uint8_t value) {
        now_ = at;
        say(I2cPhaseKind::Start, 0x40);
        answer(I2cPhaseKind::Acknowledge, 0, true);
        say(I2cPhaseKind::Write, number);
        answer(I2cPhaseKind::Acknowledge, 0, true);
        say(I2cPhaseKind::Start, 0x41);
        answer(I2cPhaseKind::Acknowledge, 0, true);
        say(I2cPhaseKind::Read, 0);
        answer(I2cPhaseKind::Data, value, false);
        say(I2cPhaseKind::Stop, 0);
    }
    BoardBus bus;

  private:
    void row(const I2cPhase& phase) { bus.add({now_, "robot0.i2c.rab", "x", "", FaultKind::None, phase}); }
    Time now_ = 0, begun_ = 0;
};

HeardFrame frame_at(Time start) {
    return {start, start + 7'600 * kMicrosecond, "a", "b", 0.3, true, false, false};
}

Poll message_at(Time time, std::uint32_t payload) {
    return {time, true, payload, 0xFFFF};
}

}  // namespace

TEST_CASE("register traffic is read from the phases on the wires") {
    Wire wire;
    wire.write(kMillisecond, 21, 32);
    wire.write(2 * kMillisecond, 13, 0x04);
    wire.write(3 * kMillisecond, 19, 0x03);
    wire.write(4 * kMillisecond, 20, 0x02);
    wire.write(5 * kMillisecond, 14, 0x01, 1'900 * kMicrosecond);
    wire.read(20 * kMillisecond, 0, 0);
    wire.read(40 * kMillisecond, 0, 1);
    wire.read(41 * kMillisecond, 1, 0xBE);
    wire.read(42 * kMillisecond, 2, 0xEF);
    const auto sends = sends_of(wire.bus.accesses());
    REQUIRE(sends.size() == 1);
    CHECK(sends[0].payload == 0x04030201u);
    const auto polls = polls_of(wire.bus.accesses());
    REQUIRE(polls.size() == 2);
    CHECK_FALSE(polls[0].message);
    CHECK(polls[1].message);
    CHECK(polls[1].payload == 0xBEEF);
    CHECK(polls[1].payload_mask == 0xFFFF);
    CHECK(poll_period(polls) == Approx(0.020));
    REQUIRE(wire.bus.busy().size() == 5);  // the slow write and four reads
    CHECK(wire.bus.busy()[0].end - wire.bus.busy()[0].begin == 1'900 * kMicrosecond);
    CHECK(wire.bus.busy()[1].end - wire.bus.busy()[1].begin == 8 * kPeriod);
}

TEST_CASE("each message belongs to the frame that carried its bytes, the others have a cause") {
    std::map<std::string, BoardTraffic> boards;
    std::vector<HeardFrame> frames;
    for (int i = 0; i < 9; ++i) {
        const Time start = (10 + 50 * i) * kMillisecond;
        frames.push_back(frame_at(start));
        boards["a"].sends.push_back({start - 2 * kMillisecond, 0x100u + static_cast<unsigned>(i)});
    }
    auto& polls = boards["b"].polls;
    polls.push_back(message_at(30 * kMillisecond, 0x100));                     // frame 0 arrives
    frames[1].heard = false;                                                   // 1: too weak
    frames[2].overlapped = true;                                               // 2: collision
    boards["b"].busy.push_back({161 * kMillisecond, 163 * kMillisecond});      // 3: receiver's bus
    boards["a"].busy.push_back({212 * kMillisecond, 212'100 * kMicrosecond});  // 4: sender's bus
    polls.push_back(message_at(280 * kMillisecond, 0x105));                    // 5 arrives
    boards["a"].busy.push_back({312 * kMillisecond, 312'010 * kMicrosecond});  // 6: too short to be felt
    // 7 follows one that was spoilt
    polls.push_back(message_at(430 * kMillisecond, 0x1FF));  // nobody sent this
    polls.push_back(message_at(431 * kMillisecond, 0x108));  // 8 arrives
    const Losses losses = explain(frames, boards, kSecond);
    REQUIRE(losses.fates.size() == 9);
    for (const int arrived : {0, 5, 8})
        CHECK(losses.fates[static_cast<std::size_t>(arrived)].delivered);
    const std::pair<int, Cause> lost[] = {{1, Cause::BelowThreshold}, {2, Cause::Collision},
                                          {3, Cause::ReceiverI2c},    {4, Cause::SenderI2c},
                                          {6, Cause::Other},          {7, Cause::AfterError}};
    for (const auto& [index, cause] : lost) {
        INFO(index);
        CHECK_FALSE(losses.fates[static_cast<std::size_t>(index)].delivered);
        CHECK(name_of(losses.fates[static_cast<std::size_t>(index)].cause) == name_of(cause));
    }
    CHECK(losses.unexplained.at("b") == 1);
    const auto groups = groups_of(losses, 0.1);
    REQUIRE(groups.size() == 3);
    CHECK(groups[0].share() == Approx(3.0 / 9.0));
    CHECK(groups[1].name == "a -> b");
    CHECK(groups[2].name == "30 to 40 cm");
}

TEST_CASE("boards that send in step are said to be locked, others not") {
    RandomStream random(GENERATE(1, 2, 3), "phases");
    constexpr Time kLoop = 22 * kMillisecond;
    const double phase = random.uniform();
    const auto lag = static_cast<Time>(phase * static_cast<double>(kLoop));
    std::map<std::string, std::vector<Time>> starts;
    Time drifting = 3 * kMillisecond;
    for (int i = 0; i < 400; ++i) {
        starts["a"].push_back(i * kLoop + static_cast<Time>(100e6 * random.normal()));
        starts["b"].push_back(i * kLoop + lag + static_cast<Time>(100e6 * random.normal()));
        starts["c"].push_back(drifting);
        drifting += kLoop + 100 * kMicrosecond;  // two turns in 400 loops
    }
    const std::vector<PhaseLock> locks = locked_phases(starts);
    REQUIRE(locks.size() == 1);
    CHECK(std::set{locks[0].leader, locks[0].follower} == std::set<std::string>{"a", "b"});
    CHECK(locks[0].period == Approx(0.022).epsilon(0.02));
    CHECK(locks[0].spread < 0.02);
    const double found = locks[0].leader == "a" ? locks[0].phase : 1 - locks[0].phase;
    CHECK(std::abs(std::remainder(found - phase, 1.0)) < 0.01);
    // Every second frame of a faster one.
    std::map<std::string, std::vector<Time>> multiple;
    for (int i = 0; i < 100; ++i) {
        if (i % 2 == 0) multiple["slow"].push_back(i * kLoop + 5 * kMillisecond);
        multiple["fast"].push_back(i * kLoop);
    }
    REQUIRE(locked_phases(multiple).size() == 1);
    CHECK(locked_phases(multiple)[0].follower == "slow");
    // Too few show nothing.
    for (auto& [name, times] : starts)
        times.resize(15);
    CHECK(locked_phases(starts).empty());
}

TEST_CASE("a frame right after another falls into the reading of the peaks") {
    std::map<std::string, BoardTraffic> boards;
    const HeardFrame first = frame_at(10 * kMillisecond), second = frame_at(first.end + 2 * kMillisecond);
    boards["a"].sends = {{9 * kMillisecond, 0x1}, {9 * kMillisecond, 0x2}};
    boards["b"].polls = {message_at(30 * kMillisecond, 0x1)};
    const Losses losses = explain({first, second}, boards, kSecond);
    CHECK(losses.fates[0].delivered);
    CHECK(losses.fates[1].cause == Cause::ReceiverPeaks);
}

TEST_CASE("a results folder is read and wrong ones are named") {
    const auto folder = tests::scratch_path("puckloop-rab-losses");
    std::filesystem::create_directories(folder);
    CHECK_THROWS_WITH(read_rab_results(folder, 0, 1), Catch::Contains("ir.csv"));
    std::ofstream(folder / "ir.csv")
        << "t_s,end_s,sender,receiver,distance_m,level_counts,carrier,receivers,heard,"
           "overlap,receiver_sending\n0.100000,0.107600,a,b,0.25,900,5.0,4,1,,1\n";
    CHECK_THROWS_WITH(read_rab_results(folder, 0, 1), Catch::Contains("trace.csv"));
    std::ofstream(folder / "trace.csv") << kTraceColumns << '\n'
                                        << to_csv({kSecond, "b.i2c.rab", "b.i2c", "", FaultKind::None,
                                                   I2cPhase{.kind = I2cPhaseKind::Stop, .start = kSecond}})
                                        << '\n';
    const RabResults results = read_rab_results(folder, 0, 9);
    REQUIRE(results.losses.fates.size() == 1);
    CHECK(results.losses.fates[0].cause == Cause::ReceiverSending);
    CHECK_THAT(to_text(results, 0.1), Catch::Contains("a -> b"));
    CHECK_THAT(to_json(results, 0.1), Catch::Contains("\"receiver_sending\": 1"));
    std::ofstream(folder / "ir.csv", std::ios::app) << "0.2,0.3";  // as a killed run leaves it
    CHECK(read_rab_results(folder, 0, 9).losses.fates.size() == 1);
    std::ofstream(folder / "ir.csv", std::ios::app) << "\n";
    CHECK_THROWS_WITH(read_rab_results(folder, 0, 9),
                      Catch::Contains("line 3") && Catch::Contains("columns"));
    std::filesystem::resize_file(folder / "ir.csv", std::filesystem::file_size(folder / "ir.csv") - 8);
    std::ofstream(folder / "ir.csv", std::ios::app) << "0.2,x,a,b,0.25,900,5.0,4,1,,1\n";
    CHECK_THROWS_WITH(read_rab_results(folder, 0, 1), Catch::Contains("line 3") && Catch::Contains("'x'"));
    std::filesystem::remove_all(folder);
}
