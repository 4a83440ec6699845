// argos3_epuck_rab: received strength of two range-and-bearing boards at 9 distances, published as mean and
// deviation of the logarithm. From demiurge-project/argos3-epuck, MIT.
//
// The set holds a fit, not readings. Each distance becomes a run whose rows are the fit's quantiles at 10, 20
// .. 90 %: they carry its median and its spread, and are no more independent than the one line they come
// from.

#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"
#include "gap/stats/tails.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::gap::importers {

namespace {

constexpr const char* kFile = "rab_lognormal_iridia.csv";
constexpr int kQuantiles = 9;

bool recognises(const std::filesystem::path& folder) {
    return std::filesystem::is_regular_file(folder / kFile);
}

std::vector<ImportedExperiment> read(const std::filesystem::path& folder) {
    const auto table = read_numbers(folder / kFile, ',', 3, 1);
    ImportedExperiment e;
    e.folder = "argos3_epuck_rab";
    e.kind = "rab";
    e.title = "range-and-bearing strength against distance, two e-pucks";
    e.robot = "e-puck with range-and-bearing board";
    e.description =
        "Published log-normal fits of the received strength at each distance. The rows are the fits' "
        "quantiles at "
        "10 to 90 %, not readings: they show median and spread, but count as one measurement a distance.";
    e.source = "github.com/demiurge-project/argos3-epuck";
    e.licence = "MIT";
    e.instruments.push_back({"strength", NAN, 4095, 0.0});
    for (std::size_t i = 0; i < table[0].size(); ++i) {
        ImportedRun run;
        run.name = fmt::format("distance_{}cm", table[0][i]);
        std::vector<double> strength;
        for (int q = 1; q <= kQuantiles; ++q)
            strength.push_back(
                std::exp(table[1][i] + table[2][i] * stats::normal_quantile(q / (kQuantiles + 1.0))));
        run.constants["distance_m"] = table[0][i] / 100;
        run.constants["emitter"] = 0;
        run.columns = {{"strength", strength}};
        run.conditions["rows"] = "quantiles of a published fit";
        e.runs.push_back(run);
    }
    return {e};
}

}  // namespace

const Importer kArgosEpuckRab{"argos3_epuck_rab",
                              "received strength of range-and-bearing boards at 9 distances", kFile,
                              recognises, read};

}  // namespace puckloop::gap::importers
