#pragma once
// The beginning of a measured experiment: a folder to be filled.

#include "gap/data/experiment.h"

#include <cstddef>
#include <string>

namespace puckloop::gap {

/// experiment.toml with a comment on every entry, for `runs` CSV files run1.csv, run2.csv, ...
std::string new_experiment_toml(const Kind& kind, std::size_t runs);
/// One header line: the time, and every column of the kind that something can be learnt from.
std::string new_csv_header(const Kind& kind);

/// Writes both. InputError where the folder holds an experiment or a run's file already.
void write_new_folder(const Kind& kind, std::size_t runs, const std::filesystem::path& folder);

}  // namespace puckloop::gap
