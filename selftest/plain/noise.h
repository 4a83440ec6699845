#pragma once
// Noise as a laboratory sees it: heavy-tailed, correlated from row to row, quantised, clipped, with rows and
// cells missing. Strengths of hidden effects are told in units of this noise.

#include "base/random.h"
#include "gap/data/written.h"

#include <string_view>

namespace puckloop::gap::selftest {

/// How the noise of one case behaves; the same for all its columns.
struct NoiseStyle {
    enum class Tail { Normal, Student, Outliers } tail = Tail::Normal;
    double memory = 0.0;         ///< lag-1 correlation
    double missing_rows = 0.0;   ///< share
    double missing_cells = 0.0;  ///< share

    /// Drawn for a case: all of tail, memory and holes vary.
    static NoiseStyle draw(RandomStream& random);
};

/// A stationary series with standard deviation `sd`.
class NoiseSeries {
  public:
    NoiseSeries(const NoiseStyle& style, double sd, RandomStream random);
    double next();

  private:
    double innovation();

    NoiseStyle style_;
    double sd_;
    double last_ = 0.0;
    bool started_ = false;
    RandomStream random_;
};

/// Rounded to multiples of `quantum` (0: left alone).
double quantised(double value, double quantum);

/// Takes rows and cells of what was measured away. `keep_rows`: a lost row keeps what was commanded and
/// counted, as a log of commands does when the tracker loses the robot.
void punch_holes(WrittenRun& run, const NoiseStyle& style, bool keep_rows, RandomStream& random);

}  // namespace puckloop::gap::selftest
