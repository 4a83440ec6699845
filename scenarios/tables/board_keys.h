#pragma once
// Keys that tables of several boards have alike.

#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::scenarios {

/// A list of times in seconds, each later than the one before, all after `start`; empty where absent.
std::vector<double> read_times(Reader& reader, std::string_view key, double start);

/// The error of a crystal or resonator, in ppm; 0 where absent.
double read_clock_error(Reader& reader, std::string_view key);

/// adc_noise: standard deviation in counts.
double read_adc_noise(Reader& reader, double fallback);

/// The name of a robot or a TAM: part of file names, and nobody else's.
std::string read_name(Reader& reader, const std::string& fallback, const Scenario& scenario);

}  // namespace puckloop::scenarios
