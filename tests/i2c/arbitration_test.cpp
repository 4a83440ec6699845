// Masters that make the same START with the same address: which of them goes on, and at which bit the other
// notices, for drawn pairs that differ at a drawn bit: in a data byte, in the ninth clock of a byte read, by
// a STOP or a repeated START against a bit. The right outcome is computed clock by clock from the two lines
// (UM10204, 3.1.8), and what each program sees is compared: BCL and TRSTAT, TWSR, EAGAIN.

#include "base/random.h"
#include "tests/i2c/masters_under_test.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <map>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {

constexpr Time kNominal = 10 * cosim::kMicrosecond;

/// What one master puts on SDA in one clock: let go or low while SCL is high, or a change meanwhile.
enum class Line { Low, High, Rises, Falls };

Line drives(const BusUnit& unit, bool again, int clock) {
    if (unit.kind == BusUnit::Kind::Stop) return Line::Rises;
    if (unit.kind == BusUnit::Kind::Address && again && clock == 1) return Line::Falls;
    if (clock == 9) return unit.kind == BusUnit::Kind::Read && unit.ack ? Line::Low : Line::High;
    if (unit.kind == BusUnit::Kind::Read) return Line::High;
    return (unit.byte >> (8 - clock) & 1) != 0 ? Line::High : Line::Low;
}

/// Whether SDA is not as this master drives it, where `other` drives it too.
bool loses(Line own, Line other) {
    switch (own) {
    case Line::Low:
        return false;
    case Line::High:
        return other != Line::High;
    case Line::Rises:
        return other == Line::Low;
    case Line::Falls:
        return other == Line::Low || other == Line::Rises;
    }
    return false;
}

struct Expected {
    int loser = -1;  ///< none: they agree to the end
    std::size_t unit = 0;
    int clock = 0;
};

Expected on_the_lines(const std::vector<BusUnit>& a, const std::vector<BusUnit>& b) {
    for (std::size_t unit = 0; unit < std::min(a.size(), b.size()); ++unit)
        for (int clock = 1; clock <= 9; ++clock) {
            // A repeated START needs no data clock of its own where both make one.
            const bool again = unit > 0 && a[unit].kind != b[unit].kind;
            const Line first = drives(a[unit], again, clock), second = drives(b[unit], again, clock);
            if (loses(first, second)) return {0, unit, clock};
            if (loses(second, first)) return {1, unit, clock};
            if (a[unit].kind == BusUnit::Kind::Stop && b[unit].kind == BusUnit::Kind::Stop) return {};
        }
    return {};
}

/// When the START of this master alone begins without a delay.
Time begins(MasterKind kind) {
    static std::map<MasterKind, Time> known;
    if (const auto found = known.find(kind); found != known.end()) return found->second;
    std::vector<MasterUnderTest> alone{{kind, {{false, {1}}}, 0}};
    run_masters(alone);
    REQUIRE(!alone[0].sent.empty());
    CHECK(!alone[0].lost);
    return known[kind] = alone[0].sent.front().phase.start;
}

/// Two transfers that are the same up to a drawn place.
std::pair<Transfer, Transfer> drawn_pair(RandomStream& random) {
    const auto byte = [&] { return static_cast<std::uint8_t>(random.below(256)); };
    Transfer common;
    const auto parts = random.below(2);
    const auto some = [&](bool read) {
        TransferPart part{read, {}};
        for (auto n = 1 + random.below(3); n > 0; --n)
            part.bytes.push_back(byte());
        return part;
    };
    for (std::uint64_t i = 0; i < parts; ++i)
        common.push_back(some(false));
    common.push_back(some(random.below(3) == 0));
    Transfer one = common, two = common;
    TransferPart& last = two.back();
    const auto die = random.below(8);
    if (last.read) {
        if (die > 0) last.bytes.resize(last.bytes.size() + 1 + random.below(2));
        if (die == 1) two.push_back(some(false));
    } else if (die < 5) {  // a bit
        const auto at = random.below(last.bytes.size());
        last.bytes[at] = static_cast<std::uint8_t>(last.bytes[at] ^ 1u << random.below(8));
        for (std::size_t i = at + 1; i < last.bytes.size(); ++i)
            last.bytes[i] = byte();
    } else if (die == 5) {
        last.bytes.push_back(byte());  // against a STOP
    } else if (die == 6) {
        last.bytes.push_back(byte());  // against a repeated START
        one.push_back(some(random.below(2) == 0));
    } else {
        two.push_back(some(true));  // a repeated START against a STOP
    }
    if (random.below(2) == 0) std::swap(one, two);
    return {one, two};
}

struct Tally {
    int same = 0, data = 0, ninth = 0, stop = 0, restart = 0;
    std::map<int, int> clocks;
};

void check_pair(MasterKind first, MasterKind second, RandomStream& random, Tally& tally, bool chopped) {
    const auto [one, two] = drawn_pair(random);
    const Time late = static_cast<Time>(random.below(7)) * 500 * cosim::kNanosecond;
    const Time start = 1500 * cosim::kMicrosecond;
    std::vector<MasterUnderTest> masters{{first, one, start - begins(first)},
                                         {second, two, start + late - begins(second)}};
    const MastersRun run = run_masters(masters);
    if (chopped) {
        std::vector<MasterUnderTest> again{{first, one, masters[0].delay}, {second, two, masters[1].delay}};
        CHECK(run_masters(again, 1 + random.below(1000)).sha == run.sha);
    }
    const Time apart = masters[0].sent.front().phase.start - masters[1].sent.front().phase.start;
    REQUIRE(std::abs(apart) < kNominal / 2);
    const std::vector<BusUnit> units[] = {units_of(one), units_of(two)};
    const Expected expected = on_the_lines(units[0], units[1]);
    for (int m = 0; m < 2; ++m) {
        const MasterUnderTest& master = masters[static_cast<std::size_t>(m)];
        INFO("master " << m);
        CHECK(master.lost == (expected.loser == m));
        const std::size_t done = expected.loser == m ? expected.unit : units[m].size();
        if (master.kind != MasterKind::Linux) CHECK(master.units_done == static_cast<int>(done));
        const auto losses =
            std::count_if(master.answered.begin(), master.answered.end(),
                          [](const auto& row) { return row.phase.kind == I2cPhaseKind::BusLost; });
        if (master.kind == MasterKind::Linux) CHECK(master.error == (expected.loser == m ? EAGAIN : 0));
        CHECK(losses == (expected.loser == m ? 1 : 0));
    }
    // The device gets what the winner writes.
    const int winner = expected.loser == 0 ? 1 : 0;
    std::vector<std::uint8_t> written;
    for (const BusUnit& unit : units[winner])
        if (unit.kind == BusUnit::Kind::Write) written.push_back(unit.byte);
    CHECK(run.written == written);
    if (expected.loser < 0) {
        ++tally.same;
        return;
    }
    // BusLost is stamped with the end of the clock in which the bit differs.
    const MasterUnderTest& loser = masters[static_cast<std::size_t>(expected.loser)];
    const MasterUnderTest& other = masters[static_cast<std::size_t>(winner)];
    const auto& lost_row = *std::find_if(loser.answered.begin(), loser.answered.end(), [](const auto& row) {
        return row.phase.kind == I2cPhaseKind::BusLost;
    });
    const Time period =
        std::max({kNominal, loser.sent[0].phase.clock_period, other.sent[0].phase.clock_period});
    const BusUnit& unit = units[expected.loser][expected.unit];
    ++tally.clocks[expected.clock];
    // The clock begins when the later of both has its byte.
    const auto begun = [&](const MasterUnderTest& master, bool read) {
        Time latest = 0;
        for (const auto& row : master.sent)
            if (row.time < lost_row.time && (!read || row.phase.kind == I2cPhaseKind::Read))
                latest = row.phase.start;
        return latest;
    };
    if (expected.clock == 9) {  // a dsPIC gives it when its program asks for that
        ++tally.ninth;
        CHECK(lost_row.time >= begun(loser, true) + 9 * period);
        return;
    }
    const BusUnit& against = units[winner][expected.unit];
    tally.stop += unit.kind == BusUnit::Kind::Stop || against.kind == BusUnit::Kind::Stop;
    tally.restart += unit.kind == BusUnit::Kind::Address || against.kind == BusUnit::Kind::Address;
    tally.data += unit.kind == BusUnit::Kind::Write && against.kind == BusUnit::Kind::Write;
    CHECK(lost_row.time == std::max(begun(loser, false), begun(other, false)) + expected.clock * period);
}

int drawn_count(int usual) {
    const char* const asked = std::getenv("PUCKLOOP_WIRE_SEEDS");
    return asked == nullptr ? usual : std::max(1, std::atoi(asked));
}

}  // namespace

TEST_CASE("pairs of masters that differ at a drawn bit: the lines decide, each sees it where it should") {
    constexpr std::pair<MasterKind, MasterKind> kPairs[] = {
        {MasterKind::Dspic, MasterKind::Dspic}, {MasterKind::Dspic, MasterKind::Avr},
        {MasterKind::Dspic, MasterKind::Linux}, {MasterKind::Avr, MasterKind::Linux},
        {MasterKind::Avr, MasterKind::Avr},     {MasterKind::Linux, MasterKind::Linux}};
    Tally tally;
    const int count = drawn_count(24);
    std::uint64_t pair = 0;
    for (const auto& [first, second] : kPairs) {
        ++pair;
        for (int seed = 1; seed <= count; ++seed) {
            INFO("pair " << static_cast<int>(first) << static_cast<int>(second) << " seed " << seed);
            RandomStream random(1000 * pair + static_cast<std::uint64_t>(seed), "arbitration");
            check_pair(first, second, random, tally, seed % 8 == 0);
        }
    }
    CHECK(tally.same >= count / 8);
    CHECK(tally.data > count);
    CHECK(tally.ninth > count / 4);
    CHECK(tally.stop > count / 4);
    CHECK(tally.restart > count / 4);
    for (int clock = 1; clock <= 9; ++clock) {
        INFO("clock " << clock);
        CHECK(tally.clocks[clock] > 0);
    }
}

// A dsPIC holds SCL low until its program asks for the next byte.
TEST_CASE("a master that shares the bus waits for the other one as long as its driver does") {
    std::vector<MasterUnderTest> masters{{MasterKind::Dspic, {{false, {1, 2}}}, 0},
                                         {MasterKind::Linux, {{false, {1, 2}}}, begins(MasterKind::Dspic)}};
    masters[0].halts = true;
    masters[1].timeout = 2 * cosim::kMillisecond;
    const MastersRun run = run_masters(masters);
    CHECK(masters[1].error == ETIMEDOUT);
    CHECK(masters[1].sent.back().phase.kind == I2cPhaseKind::Stop);
    CHECK(masters[1].sent.back().time == masters[1].sent.front().time + 2 * cosim::kMillisecond);
    CHECK(masters[0].units_done == 1);
    CHECK(!masters[0].lost);
    CHECK(run.written.empty());
}

TEST_CASE("two masters that read the same to the end both get it") {
    std::vector<MasterUnderTest> masters{
        {MasterKind::Linux, {{false, {7}}, {true, {0, 0}}}, cosim::kMillisecond},
        {MasterKind::Linux, {{false, {7}}, {true, {0, 0}}}, cosim::kMillisecond}};
    const MastersRun run = run_masters(masters);
    for (const MasterUnderTest& master : masters) {
        CHECK(master.error == 0);
        CHECK(master.read == "\x11\x12");
    }
    CHECK(run.written == std::vector<std::uint8_t>{7});
    CHECK_THAT(run.report, Catch::Contains("\"transfers\":2"));
}
