#pragma once
// experiment.db: runs and results of an experiment in SQLite.

#include "campaigns/experiment/experiment_run.h"
#include "campaigns/jobs/database.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::swarm {

class ExperimentStore {
  public:
    using Access = jobs::Database::Access;

    /// Opens or, with Write, makes it. InputError if it is another file; RunError if the disk does not take
    /// it.
    ExperimentStore(const std::filesystem::path& file, Access access);

    std::optional<std::string> note(const std::string& key) const { return database_.note(key); }
    void set_note(const std::string& key, const std::string& value) { database_.set_note(key, value); }

    /// All runs at once or, after a kill, none; those that are there stay.
    void plan(const Experiment& experiment, const std::vector<Run>& runs);
    /// One that is there already stays.
    void add_result(int id, const nlohmann::json& result);
    /// By number of the run.
    std::map<int, RunResult> results() const;

  private:
    jobs::Database database_;
};

}  // namespace puckloop::swarm
