#include "campaigns/engine/prefixes.h"

#include "base/error.h"
#include "scenarios/reader/faults/fault_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <string>

namespace puckloop::faults {

namespace fs = std::filesystem;
using cosim::Time;

namespace {

// Each takes some megabytes on disk, and a case goes through what lies between its snapshot and its fault.
constexpr std::size_t kMost = 16;
// A case that begins earlier is run whole: there is little to save.
constexpr Time kShortest = cosim::kSecond / 2;
constexpr Time kNear = cosim::kSecond / 4;
constexpr const char* kEnding = ".snap";

/// The last of `folder` that is not after `time`.
std::optional<Time> last_before(const fs::path& folder, Time time) {
    std::optional<Time> last;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const fs::path& file = entry.path();
        const std::string stem = file.stem().string();
        if (file.extension() != kEnding || stem.empty() ||
            stem.find_first_not_of("0123456789") != std::string::npos)
            continue;
        const Time at = std::stoll(stem) * cosim::kMillisecond;
        if (at <= time) last = std::max(last.value_or(at), at);
    }
    return last;
}

}  // namespace

fs::path snapshots_folder(const fs::path& out, std::uint64_t seed) {
    return out / "snapshots" / std::to_string(seed);
}

fs::path snapshot_at(const fs::path& folder, Time time) {
    return folder / fmt::format("{}{}", time / cosim::kMillisecond, kEnding);
}

Time first_begin(const Campaign& campaign, const scenarios::Scenario& scenario, const Case& one) {
    Time first = cosim::kNever;
    for (const nlohmann::json& fault : one.faults)
        first = std::min(first,
                         scenarios::read_fault(campaign.file.string(), 0, to_toml(fault, 0), scenario).begin);
    return first;
}

std::vector<Time> instants(const fs::path& folder, std::vector<Time> begins) {
    std::set<Time> wanted;
    for (const Time begin : begins) {
        const Time at = begin - begin % cosim::kMillisecond;
        if (begin == cosim::kNever || at < kShortest) continue;
        const auto there = last_before(folder, begin);
        if (!there || *there < at - kNear) wanted.insert(at);
    }
    const std::vector<Time> all(wanted.begin(), wanted.end());
    if (all.size() <= kMost) return all;
    std::vector<Time> some;
    for (std::size_t i = 0; i < kMost; ++i)
        some.push_back(all[i * all.size() / kMost]);
    return some;
}

std::shared_ptr<const cosim::RunSnapshot> Prefixes::before(std::uint64_t seed, Time time) {
    const fs::path folder = snapshots_folder(out_, seed);
    const auto at = last_before(folder, time);
    if (!at) return nullptr;
    const fs::path file = snapshot_at(folder, *at);
    for (const auto& [path, snapshot] : kept_)
        if (path == file) return snapshot;
    try {
        auto snapshot = std::make_shared<const cosim::RunSnapshot>(cosim::read_snapshot(file));
        if (kept_.size() == kMostKept) kept_.erase(kept_.begin());
        kept_.emplace_back(file, snapshot);
        return snapshot;
    } catch (const InputError&) {
        return nullptr;  // damaged, or gone: the case is run whole
    }
}

}  // namespace puckloop::faults
