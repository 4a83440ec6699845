#pragma once
// A folder of its own for each test, runs of puckloop in it, and what they leave on disk.

#include "base/json.h"
#include "tests/end_to_end/kit/process.h"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tests {

using Words = std::vector<std::string>;

/// One row of a CSV file, by column name.
using Row = std::map<std::string, std::string>;

class Workbench {
  public:
    Workbench();
    ~Workbench();
    Workbench(const Workbench&) = delete;
    Workbench& operator=(const Workbench&) = delete;

    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path file(const std::string& name, const std::string& content) const;
    /// A small scenario: one robot, its program started at 1 s, 60 s long; further tables appended.
    std::filesystem::path hello(const std::string& more = {}) const;

    /// The built puckloop; starts in the folder that tests run in.
    std::unique_ptr<Process> start(const Words& words, const std::string& input = {}) const;
    Ended puckloop(const Words& words, const std::string& input = {}) const;
    /// `puckloop run` with its results in out(name).
    Ended run(const std::string& name, Words words) const;
    std::filesystem::path out(const std::string& name) const { return folder_ / name; }

    nlohmann::json report(const std::string& name) const;
    std::vector<Row> csv(const std::string& name, const std::string& file) const;

  private:
    std::filesystem::path folder_;
};

/// File `name` of the folder that environment variable `variable` names, if both are there.
std::optional<std::filesystem::path> outside(const char* variable, const std::string& name);

/// Path and distances of robot0 in the arena of hello.toml.
struct Journey {
    double length = 0;     ///< m
    double clearance = 9;  ///< m: smallest distance of the body's edge to a wall's inner face
    double last_s = 0;     ///< time of the last row
};
Journey journey(const std::vector<Row>& trajectory, double from_s = 0);

/// Bytes that `from` sent on `link`, in order, from a trace.
std::vector<int> bytes_sent(const std::vector<Row>& trace, const std::string& link, const std::string& from);

}  // namespace puckloop::tests
