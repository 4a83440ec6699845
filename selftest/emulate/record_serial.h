#pragma once
// The serial line as a logic analyser at the main board's transmitter sees it: each answer's bytes, made by
// the board's own clock, timed by the analyser's. An experiment of kind timing; a run is one answer.

#include "selftest/emulate/record.h"

#include <filesystem>
#include <vector>

namespace puckloop::gap::emulate {

/// A whole answer of the main board: when each byte's start bit came, s since the first one's.
using SerialAnswer = std::vector<double>;
/// Those in a run's trace.csv.
std::vector<SerialAnswer> serial_answers(const std::filesystem::path& trace);
/// s from one byte of an answer to the next, by the board's clock.
inline constexpr double kSerialByte = 10.0 / 115200;

WrittenExperiment record_serial(const RecordOptions& options);

}  // namespace puckloop::gap::emulate
