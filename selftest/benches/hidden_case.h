#pragma once
// One case of the self test: what was hidden, how strongly, what the tool should say, and the experiment.

#include "gap/data/written.h"
#include "selftest/plain/noise.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::gap::selftest {

enum class Strength { None, Low, Medium, High };
/// Root mean square of an effect on the column it touches most, in units of that column's noise.
double asked_ratio(Strength strength);
const char* strength_name(Strength strength);

enum class Expect {
    Named,        ///< the effect, or both of a pair
    NoEffect,     ///< nothing was hidden
    Unexplained,  ///< what was hidden is not in the catalogue
    CannotTell    ///< the experiment does not tell two effects apart; both are to be listed
};
const char* expect_name(Expect expect);

/// A parameter of the hidden effect as the verdict would name it, with its true value.
struct Truth {
    std::string parameter;
    double value;
};

struct HiddenCase {
    std::string kind;
    Expect expect = Expect::NoEffect;
    Strength strength = Strength::None;
    double ratio = 0.0;        ///< reached; below the asked one where the plausible range ends
    std::vector<int> numbers;  ///< of the effects sheet; for CannotTell the hidden one first
    std::vector<std::string>
        called;  ///< beside each number: the catalogue's name where several share a number
    std::vector<std::string> labels;  ///< of what was hidden, in our words
    std::vector<Truth> truths;
    WrittenExperiment experiment;
};

/// What is to be made; `effects` index Bench::effects().
struct CasePlan {
    std::size_t bench = 0;
    std::vector<std::size_t> effects;
    Strength strength = Strength::None;
    Expect expect = Expect::NoEffect;
    std::uint64_t seed = 0;
    std::string variant{};       ///< of the experiment, where no effect asks for one
    double asked = 0.0;          ///< ratio to the noise, where it is not the strength's; 0: the strength's
    std::size_t least_runs = 0;  ///< performed again, with other designs, until there are so many
};

struct EffectInfo {
    int number;  ///< 0: not in the catalogue
    std::string label;
    int instead_of = 0;   ///< not 0: the made experiment does not tell it from that effect
    std::string variant;  ///< of the experiment
};

/// Standard deviation of the noise of a measured column: the floor that strengths are stated in. Of what
/// happens or not it is 1, so that the strength is the root of the share of rows that turn out otherwise.
struct NoiseFloor {
    const char* column;
    double sd;
    /// A run begins at any value (a drive's place, two clocks): what is the same in all its rows is not seen.
    bool any_beginning = false;
};

/// All that can be hidden in one kind of experiment.
class Bench {
  public:
    virtual ~Bench() = default;
    virtual const char* kind() const = 0;
    virtual std::vector<EffectInfo> effects() const = 0;
    virtual HiddenCase make(const CasePlan& plan) const = 0;

    /// The exact tables with nothing wrong, for those who hide something of their own, and what instruments
    /// then make of them.
    virtual WrittenExperiment exact(std::uint64_t seed) const = 0;
    virtual void measure(WrittenExperiment& experiment, const NoiseStyle& style,
                         std::uint64_t seed) const = 0;
    virtual std::vector<NoiseFloor> floor() const = 0;
    /// The exact tables of one effect at half of its plausible range, for several draws of what it leaves
    /// open (which sensor, which direction); one where it leaves nothing open. Empty for effects of another
    /// variant.
    virtual std::vector<WrittenExperiment> examples(std::size_t effect, std::uint64_t seed) const = 0;
};

/// One for each kind of experiment, always in the same order.
const std::vector<std::unique_ptr<Bench>>& benches();

}  // namespace puckloop::gap::selftest
