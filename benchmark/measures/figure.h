#pragma once
// What `puckloop bench` prints: figures over several rounds, each beside a reference and perhaps a peer.

#include "benchmark/measures/other_load.h"

#include <string>
#include <vector>

namespace puckloop::tools {

/// One figure. The vectors other than `values` may be empty; value i of each was measured in round i.
struct Figure {
    std::string name;
    std::string unit;
    std::vector<double> values;
    std::vector<double> references;  ///< speed of the reference loop right before each value
    std::vector<double> peers;       ///< what the other build did in the same round
    std::string note{};              ///< for the reader, such as a trace that differs; empty: nothing
};

/// Median over the rounds of value / other; 0 if there is none.
double median_ratio(const std::vector<double>& values, const std::vector<double>& others);

/// A table with median, lowest and highest of each figure, then the notes and the other load.
std::string figures_table(const std::vector<Figure>& figures, const OtherLoad& load);

/// {"figures": [{name, unit, median, lowest, highest, values, ratio_to_reference, peer_median,
/// ratio_to_peer, note}], "other_load": {...}}; what was not measured is left out.
std::string figures_json(const std::vector<Figure>& figures, const OtherLoad& load);

/// Median by name from such JSON, or from the plain list of figures that older builds print. Throws RunError.
double median_in(const std::string& json, const std::string& name);

}  // namespace puckloop::tools
