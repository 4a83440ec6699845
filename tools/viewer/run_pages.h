#pragma once
// `puckloop view` of a folder of many runs, a fault campaign's or an experiment's: its report, and behind
// each number of it the page of that run. A run whose files were not kept is carried out again, by a process
// of its own.

#include "view/answers.h"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

struct ManyRuns {
    std::string what;    ///< a run is called so: "case", "run"
    std::string report;  ///< HTML, with links as run_page() gives
    std::set<int> runs;  ///< their numbers
    /// Its files, if they were kept, else empty.
    std::function<std::filesystem::path(int)> kept;
    /// Where they are to be, and the command (without the program) that makes them there.
    std::function<std::filesystem::path(int)> folder;
    std::function<std::vector<std::string>(int)> again;
};

/// What `folder` holds; nothing: neither a campaign nor an experiment.
std::optional<ManyRuns> many_runs(const std::filesystem::path& folder);

/// The link from a report to the page of a run, at a time (s).
std::string run_page(int run, double time_s);

class RunPages {
  public:
    explicit RunPages(ManyRuns runs);
    /// Ends what it has started.
    ~RunPages();
    RunPages(const RunPages&) = delete;
    RunPages& operator=(const RunPages&) = delete;

    /// As Answers::get(); "run", its number and what is below are the page of run 12.
    std::optional<view::Content> get(std::string_view target);

    static constexpr std::size_t kMostOpen = 8;    ///< recordings in memory; the one opened first is closed
    static constexpr std::size_t kMostAtOnce = 2;  ///< runs that are carried out again

  private:
    class Again;
    struct Open;
    void reap();
    view::Content wait_for(int run);

    ManyRuns runs_;
    std::map<int, std::unique_ptr<Again>> again_;
    std::set<int> carried_out_;          // again, by this viewer
    std::map<int, std::string> failed_;  // why it could not be shown
    std::map<int, std::unique_ptr<Open>> open_;
    std::vector<int> opened_;  // in that order
};

}  // namespace puckloop::tools
