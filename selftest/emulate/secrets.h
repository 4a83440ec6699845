#pragma once
// Secret changes of the emulated robot: what is changed, and what the tool must find against the unchanged
// model. By how much is drawn at each test from the published range; the values that were typed here before
// are kept as the closed loop, because the fits' own starting values came from the same hand.

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap::emulate {

/// A number that is drawn evenly from low..high, with either sign where `both`.
struct Draw {
    double closed;     ///< in the closed loop
    double low, high;  ///< published range, or what of it the experiment can show
    bool both = false;
    const char* source = "";  ///< of the range
};

/// Parameter = base + scale * a draw. "name*" is one of `Secret::choices` names with a number, drawn.
struct Setting {
    const char* parameter;
    std::size_t draw;
    double base, scale;
};

struct Secret {
    const char* kind;
    const char* what;  ///< in plain words, without the amount
    std::vector<Draw> draws;
    std::vector<Setting> settings;
    std::vector<std::string> names;  ///< catalogue's names that are right answers
    int choices = 1;                 ///< sensors that "*" may be
    int closed_choice = 0;
    /// Not by the catalogue: an effect drawn from the grammar is put on what was recorded. The right answer
    /// is "unexplained", or "cannot tell".
    bool unknown = false;
};

/// At least sixty, a quarter of them beyond the catalogue, and for each kind one without any change (no
/// setting, no name).
const std::vector<Secret>& secrets();

/// As for set_parameter(): drawn for case `number` of a test with this seed, or the closed loop's.
std::vector<std::string> drawn_assignments(const Secret& secret, std::size_t number, std::uint64_t seed);
std::vector<std::string> closed_assignments(const Secret& secret);

}  // namespace puckloop::gap::emulate
