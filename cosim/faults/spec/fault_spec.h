#pragma once
// A fault as a scenario or the command line asks for it: where, when, what.

#include "cosim/core/time.h"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::cosim {

/// Loss in bursts, as netem's `loss gemodel`: a good and a bad state, and how likely what comes suffers in
/// either. The state changes after each that came.
struct Burst {
    double p = 0.0;     ///< good to bad, 0..1
    double r = 1.0;     ///< bad to good
    double bad = 1.0;   ///< 1-h: suffers in the bad state
    double good = 0.0;  ///< 1-k: suffers in the good state

    friend bool operator==(const Burst&, const Burst&) = default;
};

/// A kind's own parameters by key (kind_table.h). Times in seconds, ratios as parts of 1, flags 0 or 1.
struct FaultParameters {
    std::map<std::string, double, std::less<>> numbers{};
    std::map<std::string, std::string, std::less<>> texts{};

    bool has(std::string_view key) const { return numbers.contains(key) || texts.contains(key); }
    /// `fallback` where there is none.
    double number(std::string_view key, double fallback = 0.0) const;
    Time time(std::string_view key, Time fallback = 0) const;
    std::string text(std::string_view key, std::string_view fallback = {}) const;

    friend bool operator==(const FaultParameters&, const FaultParameters&) = default;
};

struct FaultSpec {
    // Where
    std::string link;  ///< the link's name; empty for a fault of a node
    std::string from;  ///< of a link: the node whose messages suffer; empty: both ends
    // What
    std::string kind = "drop";
    // When; of the candidates that match
    double probability = 1.0;     ///< 0..1
    std::uint64_t count = ~0ull;  ///< fires at most so often (on a link: in each direction)
    Time begin = 0;               ///< window: [begin, end)
    Time end = kNever;
    std::uint64_t skip = 0;        ///< the first so many in the window do not suffer
    std::uint64_t every = 1;       ///< of the rest the 1st, the 1 + every-th, ...
    Time period = 0;               ///< of what happens at instants: again after so long; 0: once, at `begin`
    std::optional<Burst> burst{};  ///< in place of a probability
    // What matches: UART frames, for a radio frame `match` is anywhere in it
    std::vector<std::uint8_t> bytes{};        ///< with one of these values; empty: all
    std::optional<std::uint32_t> position{};  ///< so far into their record (bytes sent without a pause)
    std::vector<std::uint8_t> match{};        ///< the last bytes sent were these
    std::uint32_t offset = 0;                 ///< so many bytes after that
    FaultParameters parameters{};

    std::string name{};         ///< unique in the run
    std::string node{};         ///< the node that carries the fault out; empty: the conductor, on the link
    bool may_not_fire = false;  ///< a run in which it never fired is no failure

    FaultSpec& set(std::string_view key, double value) {
        parameters.numbers.insert_or_assign(std::string(key), value);
        return *this;
    }
    FaultSpec& set(std::string_view key, std::string_view value) {
        parameters.texts.insert_or_assign(std::string(key), std::string(value));
        return *this;
    }
    FaultSpec& set(std::string_view key, const char* value) { return set(key, std::string_view(value)); }

    friend bool operator==(const FaultSpec&, const FaultSpec&) = default;
};

/// "drop on robot0.uart from robot0.pic" for reports.
std::string describe(const FaultSpec& spec);
/// Gives a name to those without: kind and place, "robot0.uart.drop", a second one "robot0.uart.drop.2".
void name_faults(std::vector<FaultSpec>& faults);

}  // namespace puckloop::cosim
