#pragma once
// A rig is one kind of experiment that can be measured with something wrong: it makes the table without
// noise, then what the instruments make of it. Knob types and formulas are the plain_*.h models'.

#include "base/random.h"
#include "selftest/benches/hidden_case.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace puckloop::gap::selftest {

/// Everything that one experiment needs: what is done is fixed by `seed` and `variant`.
template <class Knobs>
struct Rig {
    const char* kind;
    std::vector<NoiseFloor> floor;
    /// Exact tables; chance only decides what the effects themselves leave to chance.
    std::function<WrittenExperiment(const Knobs&, std::uint64_t seed, const std::string& variant)> exact;
    /// Puts noise on exact tables, quantises and clips.
    std::function<void(WrittenExperiment&, const Knobs&, const NoiseStyle&, std::uint64_t seed)> measure;
    /// Root mean square of (sd / floor sd - 1) over the rows most affected column; 0 if noise stays as it is.
    std::function<double(const Knobs&, std::uint64_t seed, const std::string& variant)> growth;
};

/// What `exact` makes of `seed`, and of other seeds after it until there are `least_runs` runs.
WrittenExperiment repeated(std::uint64_t seed, std::size_t least_runs,
                           const std::function<WrittenExperiment(std::uint64_t)>& exact);

/// What differs in a column between two exact tables of a run, in units of its noise; empty where one has no
/// such column.
std::vector<double> difference_in_noise(const WrittenRun& with, const WrittenRun& without,
                                        const NoiseFloor& noise);
/// Root mean square of the difference between two exact experiments in units of the noise floor, of the
/// column most affected.
double distance_in_noise(const WrittenExperiment& with, const WrittenExperiment& without,
                         const std::vector<NoiseFloor>& floor);

}  // namespace puckloop::gap::selftest
