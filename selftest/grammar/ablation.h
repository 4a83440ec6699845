#pragma once
// What each ground of the decision is worth: which of them alone stands between a cause and its name.

#include "gap/decide/decide.h"

#include <span>
#include <string>
#include <vector>

namespace puckloop::gap::selftest::grammar {

/// A ground that may be left out of the decision.
struct Rule {
    const char* name;
    void (*leave_out)(Grounds&);
};
std::span<const Rule> rules();

/// Names of the rules without each of which the causes would be named, where they are not. What is asked
/// after a rule that spoke was not asked: it might have spoken too.
std::vector<std::string> alone_against(const Grounds& grounds);

/// Names of the rules each of which would refuse the causes by itself, without all others. Rules may go
/// together as long as each refused cause keeps one of these.
std::vector<std::string> enough_against(const Grounds& grounds);

}  // namespace puckloop::gap::selftest::grammar
