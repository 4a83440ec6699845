#pragma once
// results.csv and what the terminal shows of a campaign.

#include "campaigns/engine/campaign.h"

#include <string>

namespace puckloop::faults {

/// results.csv: one row per case, the same bytes however the campaign was run.
void write_table(const Results& results);
std::string table_text(const Results& results);

/// Counts and findings, each with its replay command.
std::string summary(const Results& results);

/// One case: its faults as [[fault]] tables, what it showed.
std::string case_text(const Results& results, int id);

/// "puckloop faults replay out/hello 17"
std::string replay_command(const Results& results, int id);
/// The same with whole paths, for a shell in any folder.
std::string replay_command_anywhere(const Results& results, int id);

/// The same case without its campaign, for a shell: "puckloop run hello.toml --seed 1 --fault '...'"
std::string run_command(const Results& results, int id);

}  // namespace puckloop::faults
