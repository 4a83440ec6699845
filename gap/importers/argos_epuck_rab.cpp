// argos3_epuck_rab: received strength of two range-and-bearing boards at 9 distances, published as mean and
// deviation of the logarithm. From demiurge-project/argos3-epuck, MIT.

#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"

#include <cmath>

namespace puckloop::gap::importers {

namespace {

constexpr const char* kRabFile = "rab_lognormal_iridia.csv";

std::vector<WrittenExperiment> read_argos_epuck_rab(const std::filesystem::path& folder) {
    const auto table = read_numbers(folder / kRabFile, ',', 3, 1);
    WrittenExperiment e;
    e.folder = "argos3_epuck_rab";
    e.kind = "rab";
    e.title = "range-and-bearing strength against distance, two e-pucks";
    e.robot = "e-puck with range-and-bearing board";
    e.description =
        "Published log-normal fits of the received strength at each distance. A row is the median of one "
        "fit: one measurement a distance, in one run; the deviations (sigma_ln) are kept but not compared.";
    e.source = "github.com/demiurge-project/argos3-epuck";
    e.licence = "MIT";
    e.instruments.push_back({"strength", NAN, 4095, 0.0});
    WrittenRun run;
    run.name = "strength_by_distance";
    for (std::size_t i = 0; i < table[0].size(); ++i)
        run.row({{"distance_m", table[0][i] / 100},
                 {"strength", std::exp(table[1][i])},
                 {"sigma_ln", table[2][i]}});
    e.runs.push_back(run);
    return {e};
}

}  // namespace

const Importer kArgosEpuckRab{"argos3_epuck_rab",
                              "received strength of range-and-bearing boards at 9 distances", kRabFile,
                              kRabFile, read_argos_epuck_rab};

}  // namespace puckloop::gap::importers
