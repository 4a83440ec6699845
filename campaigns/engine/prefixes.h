#pragma once
// What cases share: until its first fault begins a case is the nominal run with its seed, so it goes on from
// a snapshot of that (docs/snapshots.md). Where there is none, or it cannot be used, a case is run whole: its
// results are the same.

#include "campaigns/engine/campaign_file.h"
#include "campaigns/engine/case.h"
#include "cosim/core/time.h"
#include "cosim/resume/run_snapshot.h"
#include "scenarios/description/scenario.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <vector>

namespace puckloop::faults {

/// Where snapshots of the nominal run with this seed are, in a campaign's results folder.
std::filesystem::path snapshots_folder(const std::filesystem::path& out, std::uint64_t seed);
/// The file of one at `time`, in such a folder.
std::filesystem::path snapshot_at(const std::filesystem::path& folder, cosim::Time time);

/// When the case's first fault begins; kNever if it has none. Throws InputError.
cosim::Time first_begin(const Campaign& campaign, const scenarios::Scenario& scenario, const Case& one);

/// When snapshots are worth taking, rising, whole milliseconds: each of `begins` has one before it, if it is
/// not among the first. None where `folder` has one shortly before.
std::vector<cosim::Time> instants(const std::filesystem::path& folder, std::vector<cosim::Time> begins);

/// Snapshots that were read, the last few of them.
class Prefixes {
  public:
    explicit Prefixes(std::filesystem::path out) : out_(std::move(out)) {}
    /// The last one of the nominal run with this seed that is not after `time`; null: there is none.
    std::shared_ptr<const cosim::RunSnapshot> before(std::uint64_t seed, cosim::Time time);

  private:
    static constexpr std::size_t kMostKept = 4;  // some megabytes each
    std::filesystem::path out_;
    std::vector<std::pair<std::filesystem::path, std::shared_ptr<const cosim::RunSnapshot>>> kept_;
};

}  // namespace puckloop::faults
