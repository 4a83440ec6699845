#pragma once
// Readings of emulated boards in figures, distance by distance, beside the published log-normal table.

#include "physics/ir/published_strengths.h"
#include "reproductions/rab/stage_node.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

/// What was measured at real boards at `distance` (m between the bodies), if the table has it.
std::optional<physics::PublishedStrength> published_at(double distance);

/// Order statistics of a sample.
struct Spread {
    double p5 = 0, p10 = 0, p25 = 0, median = 0, p75 = 0, p90 = 0, p95 = 0;
};
Spread spread_of(std::vector<double> values);

struct RabSummary {
    double distance = 0.0;  ///< m
    std::size_t sent = 0, received = 0, late = 0;
    std::size_t strays = 0;              ///< messages that nobody sent
    std::vector<double> strengths;       ///< range register of each frame received
    std::vector<double> bearing_errors;  ///< deg, wrapped
    Spread strength, estimate_cm, bearing_error;
    double sigma = 0.0;        ///< of the strength's logarithm
    double bearing_rms = 0.0;  ///< deg
};

/// One entry a distance, in the order of `distances`.
std::vector<RabSummary> summarise(const std::vector<RabReadingRow>& rows,
                                  const std::vector<double>& distances);

/// CSV with a head line, both ending in '\n'.
std::string summary_csv(const std::vector<RabSummary>& summary);
/// For a terminal.
std::string summary_text(const std::vector<RabSummary>& summary);

}  // namespace puckloop::tools
