#pragma once
// What a run was made of: for report.json.

#include "run/description/run_setup.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace puckloop::tools {

/// A firmware image or a Linux program.
struct UsedFile {
    std::string node;
    const char* role = "";  ///< "firmware", "program", "flashed"
    std::string file;
    std::string sha256;  ///< empty: it could not be read
};

/// Before the run, whose programs may replace themselves.
std::vector<UsedFile> used_files(const RunSetup& setup);

/// What is flashed into boards while the run goes on, in the order of its faults.
std::vector<UsedFile> flashed_files(const RunSetup& setup);

/// "files" of report.json.
nlohmann::ordered_json files_json(const std::vector<UsedFile>& files);
/// "puckloop": version and commit of this program.
nlohmann::ordered_json version_json();
/// "command_line": this process's words.
nlohmann::ordered_json command_line_json();

}  // namespace puckloop::tools
