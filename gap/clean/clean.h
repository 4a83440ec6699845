#pragma once
// What is put right or left out before anything is fitted, each with a caution: rows that were pasted, not
// measured, and cells missing in columns that the models predict from. A model would take what it takes where
// there is no such column at all (0 bytes on the line, 0 rad of incidence), and the jumps to and fro would
// look like an effect.

#include "gap/data/experiment.h"

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// Finds copies among the runs' observables (their truth, where a kind has no observable column), takes the
/// later one out and gives a caution. In kinds that are time series (motion, accelerometer, timing) only
/// whole runs are taken out: two runs may well begin alike.
void drop_copies(Experiment& experiment);

/// Leaves out the rows that only repeat a reading with a new time, where each reading was logged a number of
/// times in a row, and gives a caution. Readings that agree as often when they do not follow each other
/// (an instrument that stands still, at its end, or with noise below its step) stay. Not in series (motion,
/// timing).
void drop_repeats(Experiment& experiment);

/// Takes rows (of all columns) out of a run.
void take_out(Run& run, const std::set<std::size_t>& rows);

/// In each run: a column with one value only is filled with it, other covariates are drawn on between their
/// neighbours (temperature, battery, time) or held; where a truth or stimulus that varies is missing, what
/// was measured is left out (counts of events, received or whole, stay, with the run's usual value beside
/// them). A caution a column. InputError where most of a measurement would go. Motion has rules of its own
/// (gap/models).
void fill_missing(Experiment& experiment);

/// The cells missing in one file.
struct MissingIn {
    std::string file;
    std::size_t missing = 0, rows = 0;
};

/// "run1.csv: x_m is missing in 4 of 155 rows, which are left out", of several files "x_m is missing in 38 of
/// 2987 rows (22 runs), which are left out; most in run08.csv: 4 of 155". Rows are those of the files given;
/// `so` is what becomes of them.
std::string missing_sentence(std::string_view column, const std::vector<MissingIn>& files,
                             std::string_view so);

}  // namespace puckloop::gap
