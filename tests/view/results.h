#pragma once
// A small results folder, written as a run writes it, for tests of what reads it.

#include <filesystem>
#include <string>

namespace puckloop::tests {

/// One robot, two seconds: report, arena, trajectory, sensors, a trace of one e-puck UART with a damaged byte
/// and LEDs, a log.
std::filesystem::path write_results(const std::string& name);

void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace puckloop::tests
