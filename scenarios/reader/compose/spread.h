#pragma once
// Values that differ from unit to unit: "normal(0, 15 ppm)", "uniform(0 s, 2 s)", "choice(1, 2, 5)".

#include "base/random.h"
#include "base/text/toml_file.h"

#include <optional>
#include <string>
#include <string_view>

namespace puckloop::scenarios {

/// What is wrong with a text that begins as a distribution does.
struct SpreadError {
    std::string problem;
    std::string expected;
};

/// A value drawn from the distribution that `text` names: mean and standard deviation, least and largest
/// value, or a list of which each is as probable. The numbers have one unit, which a 0 may leave out; the
/// value is a text with that unit, a plain number where there is none. None where `text` is no distribution.
/// Throws SpreadError.
std::optional<TomlValue> drawn(std::string_view text, RandomStream& random);

}  // namespace puckloop::scenarios
