#pragma once
// A Slurm cluster of this machine alone, in a folder of its own: munge, controller and one node.

#include "tests/end_to_end/kit/process.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::tests {

class SlurmCluster {
  public:
    /// Starts it and sets SLURM_CONF for this process and its children. `missing()` gives why there is none.
    explicit SlurmCluster(const std::filesystem::path& folder);
    ~SlurmCluster();
    SlurmCluster(const SlurmCluster&) = delete;
    SlurmCluster& operator=(const SlurmCluster&) = delete;

    const std::string& missing() const { return missing_; }

  private:
    void start();
    Ended ask(const std::vector<std::string>& words) const;

    std::filesystem::path folder_;
    std::string missing_;
    std::vector<std::unique_ptr<Process>> daemons_;
};

}  // namespace puckloop::tests
