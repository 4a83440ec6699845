#pragma once
// Runs of programs on hosts and robots of a network, in every placement.

#include "tests/end_to_end/kit/workbench.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::tests {

/// A list of TOML.
std::string list_of(const Words& words);
/// Words of a program in tests/network/programs, for Python without its site folder.
Words python_words(const std::string& file, const Words& more = {});
/// The same as a list of TOML.
std::string python(const std::string& file, const Words& more = {});

/// A scenario of hosts alone: name and program of each.
std::string hosts(const std::vector<std::pair<std::string, std::string>>& programs,
                  const std::string& duration, const std::string& network = "");

std::string log_of(const Workbench& bench, const std::string& run, const std::string& node);
std::size_t count(const std::string& text, const std::string& what);

/// Runs the scenario in every placement, and once beside other work; all are the same. The first is "o0".
void check_everywhere(const Workbench& bench, const std::filesystem::path& file);

}  // namespace puckloop::tests
