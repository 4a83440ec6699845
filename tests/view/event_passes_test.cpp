// The events of a growing folder: read again while somebody looks on, and only what is new.

#include "tests/view/results.h"
#include "view/events/event_passes.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

using namespace puckloop::tests;
using namespace puckloop::view;

namespace {

void pass_time(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

template <class Condition>
bool comes_true(Condition condition) {
    for (int i = 0; i < 500; ++i, pass_time(10))
        if (condition()) return true;
    return false;
}

}  // namespace

TEST_CASE("a growing folder is read again while somebody looks on, and once more at its end") {
    const auto folder = write_results("view_passes");
    const Recording recording(folder, true);
    std::atomic<bool> on = true, stands = true;
    const EventPasses passes(
        recording,
        {[&] { return on.load(); }, [] { return std::uint64_t{0}; }, [&] { return stands.load(); }}, 0.4);
    const auto grow = [&](const char* time) {
        std::ofstream(folder / "trace.csv", std::ios::app)
            << time << ",robot0.uart1,robot0.pic,uart,44,8N1," << time << ",8.68e-06,0,\n";
    };
    REQUIRE(comes_true([&] { return passes.latest()->done(); }));
    // Of what is there already nothing is read twice; the second pass is what came while the first began.
    REQUIRE(comes_true([&] { return passes.latest() != nullptr && passes.passes() == 2; }));
    for (int i = 0; i < 50; ++i, pass_time(10))
        passes.latest();
    CHECK(passes.passes() == 2);
    grow("3.0");
    REQUIRE(comes_true([&] { return passes.latest() != nullptr && passes.passes() == 3; }));
    // Nobody looks on.
    pass_time(600);
    grow("3.1");
    pass_time(600);
    CHECK(passes.passes() == 3);
    REQUIRE(comes_true([&] { return passes.latest() != nullptr && passes.passes() == 4; }));
    // A run that goes on is left alone for a second.
    stands = false;
    grow("3.2");
    for (int i = 0; i < 40; ++i, pass_time(10))
        passes.latest();
    CHECK(passes.passes() == 4);
    on = false;  // the last one takes all of it
    REQUIRE(comes_true([&] { return passes.passes() == 5; }));
}
