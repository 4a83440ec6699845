#pragma once
// The files that a run's results depend on, each with its hash.

#include "base/json.h"
#include "scenarios/description/scenario.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::jobs {

class InputFiles {
  public:
    /// Nothing where it is empty or no regular file.
    void add(const std::filesystem::path& file);
    /// The program itself and those of its arguments that are files; paths relative to `folder`.
    void add_command(const std::vector<std::string>& words, const std::filesystem::path& folder);
    /// Everything that a run of it reads: scenario files, images, programs.
    void add_scenario(const scenarios::Scenario& scenario);

    /// {path: SHA-256}.
    const nlohmann::json& files() const { return files_; }

  private:
    nlohmann::json files_ = nlohmann::json::object();
};

}  // namespace puckloop::jobs
