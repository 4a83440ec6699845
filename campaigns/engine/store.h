#pragma once
// campaign.db: cases and results of a campaign in SQLite, each result committed when it comes.

#include "campaigns/engine/plan.h"
#include "campaigns/jobs/database.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::faults {

class Store {
  public:
    using Access = jobs::Database::Access;

    /// Opens or, with Write, makes it. InputError if it is no campaign's; RunError if the disk does not take
    /// it.
    Store(const std::filesystem::path& file, Access access);

    std::optional<std::string> note(const std::string& key) const { return database_.note(key); }
    void set_note(const std::string& key, const std::string& value) { database_.set_note(key, value); }

    bool planned(const std::string& phase) const;
    /// The highest number of a case; 0: there is none.
    int last_id() const;
    /// All of a phase at once or, after a kill, none.
    void plan(const std::string& phase, const std::vector<Case>& cases);
    std::vector<Case> cases(const std::string& phase) const;
    /// Cases of a phase that are to be run and have no result yet.
    std::vector<Case> pending(const std::string& phase) const;

    /// One that is there already stays.
    void add_result(int id, const nlohmann::json& verdict);
    /// In the order of their numbers; all phases, pruned ones left out.
    std::vector<CaseResult> results() const;
    std::vector<Case> pruned() const;

  private:
    std::vector<Case> select(const char* sql, const std::string& phase) const;

    jobs::Database database_;
};

}  // namespace puckloop::faults
