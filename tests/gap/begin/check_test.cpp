// `puckloop gap check`: everything that is wrong is listed at once, with file, row, column and remedy.

#include "gap/begin/expected_time.h"
#include "gap/begin/readiness.h"
#include "gap/data/problems.h"
#include "gap/reading/read_experiment.h"
#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>

using namespace puckloop::gap;
using namespace puckloop::gap::tests;
using Catch::Matchers::Contains;

namespace {

bool any_holds(const std::vector<std::string>& lines, std::initializer_list<const char*> parts) {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& line) {
        return std::all_of(parts.begin(), parts.end(),
                           [&](const char* part) { return line.find(part) != std::string::npos; });
    });
}

}  // namespace

TEST_CASE("every sound kind is ready, and says what can be found and how long it takes") {
    for (const char* kind :
         {"proximity", "motion", "ground", "accelerometer", "rab", "microphone", "timing"}) {
        const Folder folder(clean(kind));
        const auto begun = std::chrono::steady_clock::now();
        const Readiness ready = readiness_of(folder.path(), 1);
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        INFO(readiness_text(ready));
        CHECK(ready.problems.empty());
        CHECK(kind_name(ready.experiment->kind) == kind);
        CHECK_FALSE(ready.experiment->runs.empty());  // runs that repeat others are left out
        CHECK_FALSE(ready.looked_for.empty());
        CHECK(ready.seconds.nothing > 0);
        CHECK(seconds < 5);  // a second on an idle machine
        CHECK_THAT(readiness_text(ready), Contains("ready: a verdict takes about ") && Contains(" to ") &&
                                              Contains(" s); what is named is then performed again"));
    }
}

TEST_CASE("a cause that needs a column that is not there is listed with the column") {
    const Folder folder(clean("proximity"));
    const Readiness ready = readiness_of(folder.path(), 1);
    const auto battery = std::find_if(ready.blind.begin(), ready.blind.end(), [](const auto& blind) {
        return blind.first.find("battery_v") != std::string::npos;
    });
    REQUIRE(battery != ready.blind.end());
    CHECK(battery->second == std::vector<std::string>{"battery_droop"});
}

TEST_CASE("what is said of whole frames agrees with what can be found about broken ones") {
    const auto named = [](const std::map<std::string, std::vector<std::string>>& by_reason,
                          const char* reason, const char* cause) {
        const auto place = by_reason.find(reason);
        return place != by_reason.end() &&
               std::find(place->second.begin(), place->second.end(), cause) != place->second.end();
    };
    const auto found = [](const Readiness& ready, const char* cause) {
        return std::find(ready.looked_for.begin(), ready.looked_for.end(), cause) != ready.looked_for.end();
    };
    Made made = clean("timing");
    const Readiness without = readiness_of(Folder(made).path(), 1);
    INFO(readiness_text(without));
    CHECK(named(without.blind, "needs frame_ok to be recorded", "truncation"));
    CHECK(named(without.blind, "needs edges to be recorded and to vary; and frame_ok to be recorded",
                "baud_mismatch"));
    CHECK(named(without.blind, "needs frame_ok to be recorded and to vary", "late_answers"));
    CHECK_FALSE(found(without, "truncation"));

    made.names.insert(made.names.begin(), "frame_ok");
    for (auto& cells : made.rows)
        cells.insert(cells.begin(), "1");
    const Readiness whole = readiness_of(Folder(made).path(), 1);
    INFO(readiness_text(whole));
    CHECK(any_holds(whole.experiment->cautions, {"frame_ok is 1 in every row: nothing made it otherwise"}));
    CHECK(named(whole.absent, "frame_ok is 1 in every row", "truncation"));
    CHECK(named(whole.blind, "needs frame_ok to vary, which is 1 in every row", "late_answers"));
    CHECK_FALSE(found(whole, "truncation"));
    CHECK_THAT(readiness_text(whole), Contains("did not happen: truncation (frame_ok is 1 in every row)"));

    for (std::size_t i = 5; i < made.rows.size(); i += 20)
        made.rows[i].front() = "0";
    const Readiness broken = readiness_of(Folder(made).path(), 1);
    INFO(readiness_text(broken));
    CHECK(found(broken, "truncation"));
    CHECK(found(broken, "late_answers"));
    CHECK_FALSE(any_holds(broken.experiment->cautions, {"frame_ok"}));
}

TEST_CASE("all problems of all files are listed, not only the first") {
    Made made = clean("proximity");
    const Folder folder(made);
    // run0: text in one cell, a row too short; run1: distance in mm; run2 has no readings.
    made.rows[3][place_of(made, "reading")] = "lots";
    made.rows[7].pop_back();
    std::string csv = fmt::format("{}\n", fmt::join(made.names, ","));
    for (const auto& cells : made.rows)
        csv += fmt::format("{}\n", fmt::join(cells, ","));
    write_file(folder.path() / "run0.csv", csv);
    const Made wide = scaled(clean("proximity"), "distance_m", 1000);
    csv = fmt::format("{}\n", fmt::join(wide.names, ","));
    for (const auto& cells : wide.rows)
        csv += fmt::format("{}\n", fmt::join(cells, ","));
    write_file(folder.path() / "run1.csv", csv);
    write_file(folder.path() / "run2.csv", "t_s,sensor,distance_m,angle_rad,raeding\n0,0,0.01,0,100\n");
    const Readiness ready = readiness_of(folder.path(), 1);
    INFO(readiness_text(ready));
    CHECK(ready.problems.size() == 4);
    CHECK(any_holds(ready.problems, {"run0.csv", "row 4", "\"lots\"", "column \"reading\"", "a number"}));
    CHECK(any_holds(ready.problems, {"run0.csv", "row 8", "has 4 cells", "expected 5"}));
    CHECK(any_holds(ready.problems, {"run1.csv", "row 1", "distance_m", "wrong unit", "expected"}));
    CHECK(any_holds(ready.problems, {"run2.csv", "no column \"reading\"", "did you mean \"raeding\"?"}));
    CHECK_THAT(readiness_text(ready), Contains("not ready: 4 things"));
    // An analysis stops at the first of them.
    CHECK_THAT(refusal(folder.path()), Contains("run0.csv: row 4"));
}

TEST_CASE("a nominal number of no parameter is a problem like others") {
    Made made = clean("ground");
    made.toml = "[nominal]\n\"ground.gian\" = 1\n";
    const Readiness ready = readiness_of(Folder(made).path(), 1);
    INFO(readiness_text(ready));
    CHECK(any_holds(ready.problems, {"ground.gian", "did you mean \"ground.gain\"?"}));
    CHECK_THAT(readiness_text(ready), Contains("not ready: 1 thing"));
}

TEST_CASE("the same fault in every row does not bury the others") {
    Made made = clean("ground");
    for (auto& cells : made.rows)
        cells[place_of(made, "reading")] = "x";
    const Folder folder(made);
    const Readiness ready = readiness_of(folder.path(), 1);
    CHECK(ready.problems.size() <= 3 * (Problems::kMostOfAFile + 1));
    CHECK(any_holds(ready.problems, {"run2.csv", "and", "more of this file"}));
}

TEST_CASE("what is read for a check is what is read for an analysis") {
    for (const char* kind : {"proximity", "ground", "rab"}) {
        const Folder folder(clean(kind));
        Problems problems;
        const Experiment surveyed = survey_experiment(folder.path(), problems);
        const Experiment read = read_experiment(folder.path());
        CHECK(problems.empty());
        CHECK(surveyed.cautions == read.cautions);
        REQUIRE(surveyed.rows() == read.rows());
    }
}

TEST_CASE("the time left begins at the estimate and ends at nothing") {
    CHECK(seconds_left(30, 0, 0) == Approx(30));
    CHECK(seconds_left(30, 100, 1) == Approx(0));
    // Half done after 100 s: what is left is nearer to 100 s than to half of the estimate.
    CHECK(seconds_left(30, 100, 0.5) > 50);
    CHECK(rough_time(0.2) == "about a second");
    CHECK(rough_time(200) == "about 3 min");
}

TEST_CASE("a drive that is pushed often is expected to take several times as long") {
    const Made calm = clean("motion");
    Made pushed = calm;
    for (const std::size_t row : {20U, 41U, 62U})  // in each of three runs
        for (const char* name : {"x_m", "y_m"})
            for (std::size_t i = row; i < pushed.rows.size(); ++i) {
                std::string& cell = pushed.rows[i][place_of(pushed, name)];
                cell = fmt::format("{:.7g}", std::stod(cell) + 0.02);
            }
    const Readiness quick = readiness_of(Folder(calm).path(), 1),
                    slow = readiness_of(Folder(pushed).path(), 1);
    INFO(readiness_text(slow));
    REQUIRE(slow.problems.empty());
    CHECK(slow.seconds.something > 5 * quick.seconds.something);
}

TEST_CASE("a folder without a title is called by its name, and empty columns make one line") {
    Made made = clean("ground");
    made.names.insert(made.names.end(), {"pitch_rad", "acceleration"});
    for (auto& cells : made.rows)
        cells.insert(cells.end() - 1, {"", ""});
    std::swap(made.names[3], made.names[5]);  // the last column has the noise of each run
    made.toml = "title = \"\"\n";
    const Folder folder(made);
    const Readiness ready = readiness_of(folder.path() / "", 1);
    INFO(readiness_text(ready));
    CHECK(ready.experiment->title == folder.path().filename().string());
    CHECK(any_holds(ready.experiment->cautions, {"empty in every row of 3 runs", "pitch_rad, acceleration"}));
}
