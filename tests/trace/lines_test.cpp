// Lines as they are drawn, against edges computed by hand.

#include "trace_kit.h"

#include "base/error.h"
#include "traces/edges.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using namespace puckloop::tools;

namespace {

/// Times at which a line changes, the level it takes first given by its rest.
std::vector<Time> changes(const std::vector<TraceRow>& rows, const std::string& name) {
    const RecordedTrace trace(write_trace("lines.csv", rows), {});
    const LineSurvey found = survey(trace, FaultMarks());
    std::vector<Time> times;
    const FaultMarks none;
    EdgeStream edges(trace, none, found);
    while (const auto next = edges.next())
        for (const auto& [line, level] : next->levels)
            if (found.lines[line].full_name() == name) times.push_back(next->time);
    return times;
}

}  // namespace

TEST_CASE("a UART frame is drawn bit by bit") {
    // 0x4e, least significant bit first: 0 1 1 1 0 0 1 0 after the start bit.
    const TraceRow row = uart_row("wire", "left", {1000, 100, 0x4e});
    CHECK(changes({row}, "wire/left") == std::vector<Time>{1000, 1200, 1500, 1700, 1800, 1900});
    TraceRow lost = row;
    lost.fault = FaultKind::Drop;
    CHECK(changes({lost}, "wire/left").empty());
    CHECK(changes({lost}, "wire/left/fault") == std::vector<Time>{1000, 2000});
    UartFrame low{1000, 100, 0};
    low.is_break = 1;
    CHECK(changes({uart_row("wire", "left", low)}, "wire/left") == std::vector<Time>{1000, 2000});
}

TEST_CASE("a damaged UART line is drawn as it is") {
    // 0x4e inverted, with a pulse in the fifth bit; low behind it up to the next frame, which is sound.
    UartFrame frame{100'000, 100'000, 0x4e};
    frame.line = cosim::kLineInverted | cosim::kLineRestsLow;
    frame.glitch_at = 440;
    frame.glitch_width = 20;
    CHECK(changes({uart_row("wire", "left", frame), uart_row("wire", "left", {2'000'000, 100'000, 0xff})},
                  "wire/left") ==
          std::vector<Time>{300'000, 540'000, 560'000, 600'000, 800'000, 900'000, 1'000'000, 2'100'000});
}

TEST_CASE("an I2C byte is drawn in sixteenths of its clock") {
    std::vector<TraceRow> rows;
    I2cScript script(rows, 1600);
    const Time t = script.now();
    script.start(0xff, true, 320);
    script.stop();
    std::vector<Time> scl{t + 600};
    for (int clock = 0; clock < 9; ++clock) {
        const Time late = clock == 8 ? 320 : 0;
        scl.push_back(t + clock * 1600 + 800 + late);
        scl.push_back(t + (clock + 1) * 1600 + late);
    }
    const Time end = t + 9 * 1600 + 320;
    scl.push_back(end + 800);
    CHECK(changes(rows, "toy.i2c/scl") == scl);
    CHECK(changes(rows, "toy.i2c/sda") ==
          std::vector<Time>{t + 400, t + 700, t + 8 * 1600 + 400, end + 100, end + 400, end + 1200});
}

TEST_CASE("signals of 0 and 1 are lines, others are not") {
    const auto at = [](Time time, double value) {
        TraceRow row{time, "w", "board", "led", FaultKind::None, Signal{3, value}};
        return row;
    };
    CHECK(changes({at(10, 1), at(20, 1), at(30, 0)}, "w/board/led") == std::vector<Time>{10, 30});
    const RecordedTrace trace(write_trace("pins.csv", {at(10, 1), at(20, 0.5)}), {});
    CHECK_FALSE(survey(trace, FaultMarks()).lines.at(0).logic);
}
