#pragma once
// Scenarios, experiments and images as the command line names them.

#include <filesystem>
#include <string>

namespace puckloop::tools {

/// The file itself if it is there; else the shipped scenario of this name ("hello", "hello.toml"); else
/// `given` again, whose reader then refuses it. Throws InputError where the file is a firmware image.
std::filesystem::path scenario_named(const std::filesystem::path& given);

/// The same of an experiment file ("aggregation_machine", "scenarios/experiments/aggregation.toml").
std::filesystem::path experiment_named(const std::filesystem::path& given);

/// The same of a file with [mission] ("foraging"; a scenario has one too) and of a campaign ("own").
std::filesystem::path mission_named(const std::filesystem::path& given);
std::filesystem::path campaign_named(const std::filesystem::path& given);

/// The same of a firmware image ("epuck.hex", "tam.elf").
std::string image_named(const std::string& given);

}  // namespace puckloop::tools
