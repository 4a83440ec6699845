#pragma once
// Whose run a snapshot is: the request that made it, what its nodes and links were made from, and its faults.
// A run goes on from it only if all of that is the same, but for faults that begin later.

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

#include <set>
#include <string>

namespace puckloop::tools {

/// As JSON text (cosim::RunSnapshot::origin). Reads every file that nodes are made from, for its hash.
std::string origin_of(const RunSetup& setup, const RunRequest& request);

/// What `origin` was made of, with the faults, duration, placement and so on of `request`. Throws InputError
/// naming `file`.
RunRequest request_from(const std::string& origin, const RunRequest& request, const std::string& file);

/// Throws InputError naming `file` if `setup` is of another run than `origin`, whose snapshot is of `time`.
/// What has become of the files in `kept` does not matter: they are there as they were.
void check_origin(const std::string& origin, const RunSetup& setup, cosim::Time time, const std::string& file,
                  const std::set<std::string>& kept = {});

}  // namespace puckloop::tools
