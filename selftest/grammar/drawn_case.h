#pragma once
// One randomly drawn case: nothing, an effect of the catalogue, a near miss of one, or something that is not
// in the catalogue. Drawn without regard to how the analysis works; the seed is new at each full run and
// recorded.

#include "selftest/benches/hidden_case.h"
#include "selftest/grammar/site.h"

#include <string>
#include <vector>

namespace puckloop::gap::selftest::grammar {

enum class Class { Null, Known, NearMiss, Unknown, NoisyInput };
const char* class_name(Class of);

struct DrawnCase {
    Class of = Class::Null;
    HiddenCase hidden;   ///< what was hidden as far as the catalogue has a name for it; the experiment
    std::string text;    ///< what was hidden, in full
    std::string family;  ///< of a near miss: of the catalogue's effect that it resembles
    double asked = 0.0;  ///< strength over noise that was drawn; `hidden.ratio` was reached
    double likeness =
        0.0;  ///< share of what it does (of the sum of squares) that one catalogue effect could do
    std::vector<int> alike;  ///< numbers of catalogue effects that could do more than kMostLikeness of it
    int redrawn = 0;         ///< earlier draws that one catalogue effect could do most of
    std::size_t runs = 0;
};

/// Of an unknown effect no single effect of the catalogue may be able to make more than this share: beyond it
/// a name would not be wrong.
inline constexpr double kMostLikeness = 0.5;

/// Case `number` of a run with this seed. Kinds and classes take turns; everything else is drawn, how many
/// runs there are only with `draw_runs`. With `least_runs` everything is performed again, with the same
/// change and other designs, until there are so many.
DrawnCase drawn_case(std::size_t number, std::uint64_t seed, bool draw_runs = false,
                     std::size_t least_runs = 0);
/// The same case with `count` of its runs, drawn at random; fewer runs are among those of more.
DrawnCase with_runs(const DrawnCase& drawn, std::size_t count, std::uint64_t seed);
Class class_of(std::size_t number);

/// Noise of the measured columns of a kind, in the self test's experiments.
std::vector<NoiseFloor> floor_of(const std::string& kind);
/// Amplitude that moves what is measured by `asked` times its noise, as nearly as it can be had; `reached`
/// says.
double amplitude_for(const WrittenExperiment& exact, const Site& site, const Field& field, double asked,
                     const std::vector<NoiseFloor>& floor, const RandomStream& chance, double& reached);

/// Share of what `with` does beside `rest` that a weighted sum of an effect's `examples` makes, effect by
/// effect.
std::vector<double> likenesses_of(const WrittenExperiment& with, const WrittenExperiment& rest,
                                  const std::vector<std::vector<WrittenExperiment>>& examples,
                                  const std::vector<NoiseFloor>& floor);

}  // namespace puckloop::gap::selftest::grammar
