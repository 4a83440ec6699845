#pragma once
// Self test of a kind that its user described: data drawn from the kind's own formulas with one of its
// effects hidden, with nothing hidden, and with something hidden that is none of them; what the tool says of
// each, counted. It shows whether the effects of a file can be told apart by experiments of the size tried;
// it cannot show that the formulas are true, which only measurements can.

#include "gap/kinds/kind.h"
#include "gap/stats/rate.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace puckloop::gap::selftest {

enum class HiddenIn { Kind, Nothing, Outside };

struct DescribedCase {
    HiddenIn hidden = HiddenIn::Nothing;
    std::string effect;  ///< of the kind, or in words what is outside of it
    double ratio = 0.0;  ///< root mean square of what it does, in units of the noise
    std::string error;   ///< not empty: the analysis failed
    std::string said;    ///< decision
    std::vector<std::string> named;
    double wall_s = 0.0;

    bool first_right() const { return hidden == HiddenIn::Kind && !named.empty() && named.front() == effect; }
    /// Something was named that was not hidden, or beside it in front of it.
    bool wrong() const { return !named.empty() && !first_right(); }
};

struct DescribedTest {
    std::size_t cases = 30;  ///< a third of each
    std::uint64_t seed = 1;
    unsigned workers = 2;
    std::filesystem::path scratch;
    bool keep = false;
    std::function<void(const DescribedCase&, std::size_t done)> done;  ///< from one thread at a time
};

/// InputError where the kind's ranges leave nothing to draw.
std::vector<DescribedCase> described_test(const Kind& kind, const DescribedTest& test);

/// What was said of them as text, with Clopper and Pearson's limits.
std::string described_text(const std::vector<DescribedCase>& cases, const DescribedTest& test);
std::string described_line(const DescribedCase& one);

/// Names that were not hidden are few: the lower limit of their rate is at most 5 %, and nothing failed.
bool described_met(const std::vector<DescribedCase>& cases);

}  // namespace puckloop::gap::selftest
