#pragma once
// What a verdict on range and bearing means for the infra-red medium.

#include <map>
#include <string>

namespace puckloop::gap {

/// Takes the parameters of the strength, bearing and loss out of `fitted` and sets the medium's (`ir.*`) in
/// `simulator` so that a board reports what they say. What the medium has nothing for stays in `fitted`.
void rab_overlay(std::map<std::string, double>& fitted, std::map<std::string, double>& simulator);

}  // namespace puckloop::gap
