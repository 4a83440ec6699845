// The fast path of the analysis says what the whole run with the firmware in the loop says, within the
// instruments' noise: nothing changed, nothing seen.

#include "gap/data/experiment.h"
#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"
#include "selftest/emulate/record.h"
#include "tests/gap/simulated.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

struct Errors {
    double mean = 0.0, rms = 0.0, most = 0.0;
    std::size_t rows = 0;
};

Errors errors_of(const std::string& kind, const std::string& observable) {
    emulate::RecordOptions options;
    options.tools = {PUCKLOOP_RECORD, PUCKLOOP_FIRMWARE, PUCKLOOP_RAB_FIRMWARE};
    options.brief = true;
    options.scratch = tests::scratch_path("gap_fast_" + kind);
    const auto folder = options.scratch / "experiment";
    write_folder(emulate::record(kind, options), folder);
    const Experiment experiment = read_experiment(folder);
    Errors e;
    for (const Series& series : test::simulated(experiment)) {
        if (series.observable != observable) continue;
        for (std::size_t i = 0; i < series.measured.size(); ++i) {
            const double error = series.measured[i] - series.before[i];
            e.mean += error;
            e.rms += error * error;
            e.most = std::max(e.most, std::abs(error));
            ++e.rows;
        }
    }
    std::filesystem::remove_all(options.scratch);
    REQUIRE(e.rows > 20);
    e.mean /= static_cast<double>(e.rows);
    e.rms = std::sqrt(e.rms / static_cast<double>(e.rows));
    return e;
}

}  // namespace

TEST_CASE("commands become way as the firmware's timers and the world make it") {
    const Errors along = errors_of("motion", "along");
    INFO("mean " << along.mean << " rms " << along.rms << " most " << along.most);
    // The tracker's 0.5 mm, summed errors of its heading, and 2.5 mm for the row in which the speed changes.
    CHECK(std::abs(along.mean) < 0.001);
    CHECK(along.rms < 0.0015);
    CHECK(along.most < 0.005);
}

TEST_CASE("proximity readings are the table's through sampling and whole counts") {
    const Errors reading = errors_of("proximity", "reading");
    INFO("mean " << reading.mean << " rms " << reading.rms << " most " << reading.most);
    // Two conversions of 2 counts each and their rounding: 2.9 counts.
    CHECK(std::abs(reading.mean) < 1.0);
    CHECK(reading.rms < 4.0);
    CHECK(reading.most < 15.0);
}

TEST_CASE("a loudspeaker's levels come through board and firmware as the law has them") {
    const Errors level = errors_of("microphone", "level");
    INFO("mean " << level.mean << " rms " << level.rms << " most " << level.most << " rows " << level.rows);
    // Levels of 300 to 900 counts, each scattering by 12 %.
    CHECK(std::abs(level.mean) < 4 * 100 / std::sqrt(static_cast<double>(level.rows)));
    CHECK(level.rms > 30);
    CHECK(level.rms < 110);
}

TEST_CASE("tilts come through the accelerometer as gravity's share") {
    for (const char* axis : {"ax", "ay", "az"}) {
        const Errors counts = errors_of("accelerometer", axis);
        INFO(axis << " mean " << counts.mean << " rms " << counts.rms << " most " << counts.most);
        CHECK(std::abs(counts.mean) < 1.2);  // the converter's 2 counts, over 20 rows and more
        CHECK(counts.rms < 3.5);             // and what the firmware's interrupts shake
    }
}

TEST_CASE("ground readings are the printed grey's") {
    const Errors reading = errors_of("ground", "reading");
    INFO("mean " << reading.mean << " rms " << reading.rms << " most " << reading.most);
    CHECK(std::abs(reading.mean) < 1.0);  // noise of 1.5 counts
    CHECK(reading.rms < 2.5);
}
