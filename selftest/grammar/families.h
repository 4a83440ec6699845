#pragma once
// Effects of the catalogue that act at the same place in the same manner: what a near miss of one of them may
// be taken for.

#include <string>
#include <string_view>

namespace puckloop::gap::selftest::grammar {

/// "" for a name that is not known.
std::string_view family_of(std::string_view effect);

}  // namespace puckloop::gap::selftest::grammar
