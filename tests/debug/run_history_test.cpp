// A run's past in memory: each snapshot comes back as it was taken, however many there were since.

#include "run/past/run_history.h"

#include <catch2/catch.hpp>

#include <map>
#include <random>

using namespace puckloop;
using cosim::RunSnapshot;
using cosim::Time;
using tools::RunHistory;

namespace {

/// Two wires, one of which keeps what it carries.
struct Wires {
    cosim::SentRecord kept{true}, counted{false};
    std::vector<cosim::TraceRecord> arrived;

    void carry(std::mt19937& random, Time time) {
        const cosim::Signal signal{static_cast<std::uint16_t>(random() % 7),
                                   static_cast<double>(random() % 99)};
        kept.add(time, signal);
        counted.add(time, signal);
        cosim::TraceRecord record;
        record.time = time;
        record.payload = signal;
        arrived.push_back(record);
    }
    RunSnapshot snapshot(Time time) const {
        RunSnapshot taken;
        taken.time = time;
        taken.wires = {{arrived.size(), 0, true, kept, arrived}, {arrived.size(), 0, false, counted, {}}};
        return taken;
    }
};

void check_same(const RunSnapshot& got, const RunSnapshot& taken) {
    REQUIRE(got.wires.size() == taken.wires.size());
    for (std::size_t w = 0; w < got.wires.size(); ++w) {
        const cosim::WireState &a = got.wires[w], &b = taken.wires[w];
        CHECK(a.sequence == b.sequence);
        CHECK(a.faulty == b.faulty);
        CHECK(a.sent.count() == b.sent.count());
        CHECK(a.sent.digest() == b.sent.digest());
        CHECK(a.sent.keeps() == b.sent.keeps());
        CHECK(a.sent.messages(3) == b.sent.messages(3));
        CHECK(a.arrived.size() == b.arrived.size());
    }
}

}  // namespace

TEST_CASE("snapshots in memory come back as they were taken, the latest before an instruction") {
    std::mt19937 random(Catch::rngSeed() + 21);
    for (int round = 0; round < 5; ++round) {
        RunHistory history;
        history.begin(nullptr, {{{0, 0}}, 0, 0});
        Wires wires;
        std::map<Time, RunSnapshot> taken;
        const int count = 1 + static_cast<int>(random() % 150);
        Time time = 0;
        for (int i = 0; i < count; ++i) {
            const Time due = history.next(time);
            REQUIRE(due >= time + RunHistory::kFirstInterval);
            for (std::uint64_t n = random() % 5; n > 0; --n)
                wires.carry(random, due - 1);
            time = due;
            taken[time] = wires.snapshot(time);
            RunSnapshot given = taken[time];
            history.take(given, {{{static_cast<std::uint64_t>(time), static_cast<std::size_t>(i)}}, 7, 8});
            CHECK(history.count() <= RunHistory::kMost);
        }
        CHECK(history.snapshot(0) == nullptr);
        CHECK_FALSE(history.before(0, 0));
        for (std::size_t i = 1; i < history.count(); ++i) {
            const auto got = history.snapshot(i);
            REQUIRE(taken.contains(got->time));
            check_same(*got, taken[got->time]);
            const std::uint64_t cycle = history.place(i).boards[0].cycle;
            CHECK(cycle == static_cast<std::uint64_t>(got->time));
            CHECK(history.before(0, cycle) == i - 1);
            CHECK(history.before(0, cycle + 1) == i);
        }
        // In its past the run takes none, and what a file is given there is no news.
        CHECK(history.next(0) > time);
        const std::size_t before = history.count();
        RunSnapshot again = taken.begin()->second;
        history.take(again, {{{1, 0}}, 0, 0});
        CHECK(history.count() == before);
    }
}
