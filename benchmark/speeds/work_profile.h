#pragma once
// What a run's work was made of, by cause: what its boards executed, passed and executed again, what was
// granted, handed over and copied, by kind of node. Counted in this process, with one thread.

#include "run/description/run_request.h"

#include <map>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Sums over the nodes of one kind.
struct KindWork {
    std::string kind;  ///< the last part of their names: "pic", "rab", "i2c", "linux", "world", "ir"
    std::size_t nodes = 0;
    std::vector<std::pair<std::string, double>> counts;  ///< in the order of the first node's

    double count(const std::string& name) const;  ///< 0 if there is none
};

struct WorkProfile {
    double simulated_s = 0;
    std::vector<KindWork> kinds;             ///< in the order of the run's nodes
    std::map<std::string, double> messages;  ///< that arrived, both ways, by kind of link

    const KindWork* kind(const std::string& name) const;  ///< null if there is none
    /// Instructions that had to be executed once: those of all boards less what was passed in loops and
    /// service routines, and less what was executed again.
    double instructions_needed() const;
};

/// Runs `request`, which is to be in this process. Throws InputError and RunError as a run does.
WorkProfile profile_work(const RunRequest& request);

}  // namespace puckloop::tools
