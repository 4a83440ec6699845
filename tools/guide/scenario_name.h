#pragma once
// A scenario as the command line names it.

#include <filesystem>

namespace puckloop::tools {

/// The file itself if it is there; else the shipped scenario of this name ("hello", "hello.toml"); else
/// `given` again, whose reader then refuses it. Throws InputError where the file is a firmware image.
std::filesystem::path scenario_named(const std::filesystem::path& given);

/// The same of an experiment file ("aggregation_machine", "scenarios/experiments/aggregation.toml").
std::filesystem::path experiment_named(const std::filesystem::path& given);

}  // namespace puckloop::tools
