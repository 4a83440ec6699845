#pragma once
// NAME=NUMBER, as --set takes it.

#include <map>
#include <string>
#include <vector>

namespace puckloop::tools {

/// By name; of one that is there twice the last. Throws InputError for what is no such thing.
std::map<std::string, double> assignments_of(const std::vector<std::string>& texts);

}  // namespace puckloop::tools
