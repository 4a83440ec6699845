// Readings that were logged two or three times count once; readings that agree because they have no noise, or
// none that the step shows, stay.

#include "base/random.h"
#include "gap/clean/clean.h"
#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"
#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <string>

using namespace puckloop;
using namespace puckloop::gap;
using Catch::Matchers::Contains;
using puckloop::gap::tests::write_file;

namespace {

constexpr std::uint64_t kSeed = 4130;
constexpr int kRuns = 6, kGreys = 8, kSensors = 3;

/// How readings of a floor came about: three sensors above greys in drawn order.
struct Protocol {
    int measured = 1;      ///< times anew, one after another
    int logged = 1;        ///< times each of these was written
    bool in_turn = false;  ///< sensors take turns row by row, as a loop reads them
    double noise = 3.0;    ///< counts
    double carry = 0.0;    ///< of the noise, from row to row
    double placed = 0.0;   ///< sd of each placement's grey
    double gain2 = 1.0;    ///< of the last sensor
};

Experiment floor_of(const Protocol& how) {
    RandomStream random(kSeed, "repeats test");
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.instruments["reading"] = {0, 1023, 1};
    for (int r = 0; r < kRuns; ++r) {
        Run run;
        run.name = run.file = "run" + std::to_string(r);
        double error = random.normal(), time = 0.0;
        const auto write = [&](int sensor, double grey, double reading) {
            time += 0.1;
            run.columns["t_s"].push_back(time);
            run.columns["sensor"].push_back(sensor);
            run.columns["grey"].push_back(grey);
            run.columns["reading"].push_back(std::clamp(std::round(reading), 0.0, 1023.0));
            ++run.rows;
        };
        const auto read = [&](int sensor, double grey) {
            error = how.carry * error + std::sqrt(1 - how.carry * how.carry) * random.normal();
            const double level = 329 + (953 - 329) * grey;
            return (sensor == 2 ? how.gain2 : 1.0) * level + how.noise * error;
        };
        for (int k = 0; k < 5 * kGreys; ++k) {
            const double grey = std::floor(random.uniform() * kGreys) / (kGreys - 1);
            const double real = grey + how.placed * random.normal();
            for (int m = 0; m < how.measured; ++m) {
                double readings[kSensors];
                for (int s = 0; s < kSensors; ++s)
                    readings[s] = read(s, real);
                for (int n = 0; n < how.logged * kSensors; ++n) {
                    const int sensor = how.in_turn ? n % kSensors : n / how.logged;
                    write(sensor, grey, readings[sensor]);
                }
            }
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

/// As it is read from a folder.
Experiment read_back(const Experiment& experiment) {
    const gap::tests::Folder folder;
    std::string toml =
        "kind = \"ground\"\n[instrument]\nreading = { floor = 0, ceiling = 1023, quantum = 1 }\n";
    for (const Run& run : experiment.runs) {
        std::string csv = "t_s,sensor,grey,reading\n";
        for (std::size_t i = 0; i < run.rows; ++i)
            csv += fmt::format("{},{},{},{}\n", run.column("t_s")[i], run.column("sensor")[i],
                               run.column("grey")[i], run.column("reading")[i]);
        write_file(folder.path() / (run.file + ".csv"), csv);
        toml += fmt::format("[[run]]\nfile = \"{}.csv\"\n", run.file);
    }
    write_file(folder.path() / "experiment.toml", toml);
    return read_experiment(folder.path());
}

/// Rows left of each that was there.
double kept(Experiment experiment) {
    const auto before = static_cast<double>(experiment.rows());
    drop_repeats(experiment);
    CHECK(experiment.cautions.empty() == (static_cast<double>(experiment.rows()) == before));
    return static_cast<double>(experiment.rows()) / before;
}

}  // namespace

TEST_CASE("readings that were logged several times count once") {
    CHECK(kept(floor_of({.logged = 2})) == Approx(1 / 2.0).margin(0.01));
    CHECK(kept(floor_of({.logged = 3})) == Approx(1 / 3.0).margin(0.01));
    CHECK(kept(floor_of({.logged = 12})) == Approx(1 / 12.0).margin(0.01));
    CHECK(kept(floor_of({.logged = 3, .in_turn = true})) == Approx(1 / 3.0).margin(0.01));
    CHECK(kept(floor_of({.measured = 2, .logged = 2})) == Approx(1 / 2.0).margin(0.01));
    CHECK(kept(floor_of({.logged = 2, .noise = 0.6})) == Approx(1 / 2.0).margin(0.01));
}

TEST_CASE("readings that were measured anew stay, however much alike") {
    CHECK(kept(floor_of({.measured = 3})) == 1.0);
    CHECK(kept(floor_of({.measured = 3, .noise = 0.3})) == 1.0);
    CHECK(kept(floor_of({.measured = 3, .noise = 0.3, .placed = 0.01})) == 1.0);
    CHECK(kept(floor_of({.measured = 3, .noise = 0.0})) == 1.0);  // as if it stood still
    CHECK(kept(floor_of({.measured = 2, .noise = 0.01})) == 1.0);
    CHECK(kept(floor_of({.measured = 3, .carry = 0.97})) == 1.0);
    CHECK(kept(floor_of({.measured = 3, .gain2 = 3.0})) == 1.0);  // one sensor at its end
}

TEST_CASE("readings that were logged three times give the verdict of those that were measured") {
    Protocol how{.logged = 3};
    const Experiment same = read_back(floor_of(how));
    REQUIRE_FALSE(same.cautions.empty());
    CHECK_THAT(same.cautions.front(), Contains("each reading stands 3 times in a row"));
    CHECK(analyse(same).decision == Decision::NoEffect);
    how.gain2 = 0.95;
    const Verdict verdict = analyse(read_back(floor_of(how)));
    CHECK(verdict.decision == Decision::Named);
    REQUIRE_FALSE(verdict.causes.empty());
    CHECK(verdict.causes.front().name == "ground_gain");
}
