#pragma once
// Scores from elsewhere, real robots or another model, beside those of an experiment.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::swarm {

/// Scores by program and condition; the condition is empty where the file has no such column.
using Scores = std::map<std::pair<std::string, std::string>, std::vector<double>>;

struct Reference {
    std::filesystem::path file;
    bool has_conditions = false;
    Scores scores;
};

/// A CSV file with a header: columns `program` and `score`, `condition` if there are several, others are
/// ignored; one row per run. A row with an empty score is a run without one. Throws InputError with file and
/// line.
Reference read_reference(const std::filesystem::path& file);

}  // namespace puckloop::swarm
