#include "campaigns/engine/case_run.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "base/text_file.h"
#include "run/factory/node_factory.h"
#include "run/plan/overrides.h"
#include "run/run_scenario.h"
#include "run/setup.h"
#include "scenarios/reader/faults/fault_tables.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace puckloop::faults {

namespace {

constexpr double kStall = 60.0;  ///< s of wall time: a busy machine must not make a hang
constexpr int kFailed = 3;       ///< status of a child that leaves a message
constexpr int kRefused = 2;      ///< the same, of what the user gave
constexpr int kBroke = 4;        ///< the same, of an exception that nothing outside explains

tools::RunRequest request_of(const Campaign& campaign) {
    tools::RunRequest request;
    request.scenario = campaign.scenario;
    request.firmware = campaign.firmware;
    request.linux_command = campaign.program;
    request.duration = campaign.duration;
    request.in_process = true;
    request.threads = 1;
    request.stall_seconds = kStall;
    return request;
}

/// Of a node that could not write: what it reports is no outcome.
bool names_disk(const std::string& text) {
    constexpr std::array kErrors{ENOSPC, EDQUOT};
    return std::any_of(kErrors.begin(), kErrors.end(),
                       [&](int error) { return text.find(std::strerror(error)) != std::string::npos; });
}

/// The emulator broke off in the midst of the run. The run's report states it, and the verdict is taken from
/// there; a file that cannot be written is another matter.
bool broke_off(const cosim::Outcome& outcome) {
    return outcome.reason == cosim::EndReason::Failed && outcome.grants > 0 && !names_disk(outcome.text) &&
           outcome.text.find("cannot be written") == std::string::npos &&
           outcome.text.find("cannot write") == std::string::npos;
}

/// Signals that come from outside: of the user, of a machine without memory, of a limit.
bool is_from_outside(int signal) {
    constexpr std::array kSignals{SIGKILL, SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGXCPU, SIGXFSZ};
    return std::find(kSignals.begin(), kSignals.end(), signal) != kSignals.end();
}

/// A program may have met a full disk without a word of ours; empty if there is room.
std::string full_disk(const std::filesystem::path& folder) {
    constexpr std::uintmax_t kLeast = 64 * 1024;  // bytes
    std::error_code error;
    const auto space = std::filesystem::space(folder, error);
    if (error || space.available >= kLeast) return {};
    return fmt::format("{}: the disk is full ({} KiB are left)", folder.string(), space.available / 1024);
}

/// In the child: never returns.
[[noreturn]] void run_here(const Campaign& campaign, const Case& one, const std::filesystem::path& folder,
                           const CaseStart& start, int message) {
    std::string problem;
    int status = kFailed;
    try {
        tools::RunRequest request = request_of(campaign);
        request.out = folder;
        request.seed = one.seed;
        request.cache = true;
        for (nlohmann::json fault : one.faults) {
            fault["may_not_fire"] = true;  // that is an outcome
            request.faults.push_back(as_words(fault));
        }
        request.snapshot = start.snapshot;
        request.same_origin = true;
        for (const cosim::Time at : start.save_at)
            request.snapshot_at.push_back(cosim::to_seconds(at));
        if (!start.save_at.empty()) {
            request.save = start.snapshots;
            request.save_name = [&](double at) {
                return snapshot_at(start.snapshots, cosim::from_seconds(at));
            };
        }
        const auto run = [&] { return tools::run_scenario(tools::set_up(request), request, {}, nullptr); };
        cosim::Outcome outcome = run();
        if (start.snapshot && !outcome.went_on) {
            request.snapshot = nullptr;
            outcome = run();
        }
        // No fault of the case's: results that cannot be written, say.
        const bool ours = outcome.node.empty() && outcome.text.find("never fired") == std::string::npos;
        if (!outcome.success && !broke_off(outcome) && (ours || names_disk(outcome.text)))
            problem = outcome.text;
        if (problem.empty()) problem = full_disk(folder);
    } catch (const InputError& error) {
        problem = error.what();
        status = kRefused;
    } catch (const RunError& error) {
        problem = error.what();
    } catch (const std::bad_alloc&) {
        problem = "no memory is left";
    } catch (const std::exception& error) {
        problem = reason_of(error);
        status = kBroke;
    }
    if (problem.empty()) ::_exit(0);
    [[maybe_unused]] const auto written = ::write(message, problem.data(), problem.size());
    ::_exit(status);
}

std::string read_all(int descriptor) {
    std::string text;
    std::array<char, 4096> part{};
    for (;;) {
        const auto count = ::read(descriptor, part.data(), part.size());
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) return text;
        text.append(part.data(), static_cast<std::size_t>(count));
    }
}

}  // namespace

scenarios::Scenario scenario_of(const Campaign& campaign) {
    scenarios::Scenario scenario = scenarios::read_scenario(campaign.scenario);
    tools::apply(request_of(campaign), scenario);
    scenarios::check_ending(scenario);
    return scenario;
}

void check_fault(const Campaign& campaign, const scenarios::Scenario& scenario, const nlohmann::json& fault,
                 int line) {
    scenarios::read_fault(campaign.file.string(), 0, to_toml(fault, line), scenario);
}

void check_faults_of_nodes(const Campaign& campaign,
                           const std::vector<std::pair<nlohmann::json, int>>& faults,
                           const std::filesystem::path& folder) {
    std::error_code error;
    make_folder(folder);
    constexpr std::size_t kAtOnce = 256;
    for (std::size_t from = 0; from < faults.size(); from += kAtOnce) {
        tools::RunRequest request = request_of(campaign);
        request.cache = false;
        request.out = folder;
        for (std::size_t i = from; i < std::min(faults.size(), from + kAtOnce); ++i) {
            nlohmann::json fault = faults[i].first;
            fault["name"] = fmt::format("{} (line {}; {})", value_text(fault.value("kind", "drop")),
                                        faults[i].second, i + 1);
            request.faults.push_back(as_words(fault));
        }
        try {
            for (const tools::PlannedNode& node : tools::set_up(request).nodes)
                if (!node.what.faults.empty() && tools::has_board(node.what)) tools::make_board(node.what);
        } catch (const InputError& refused) {
            throw InputError(campaign.file.string(), "", refused.what());
        }
    }
    std::filesystem::remove_all(folder, error);
}

void execute(const Campaign& campaign, const Case& one, const std::filesystem::path& folder,
             const CaseStart& start) {
    std::error_code error;
    std::filesystem::remove_all(folder, error);
    make_folder(folder);
    ::setenv("PUCKLOOP_CACHE", start.boots.c_str(), 1);
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0)
        throw RunError(fmt::format("no pipe: {}", std::strerror(errno)));
    const pid_t parent = ::getpid();
    const pid_t child = ::fork();
    if (child == 0) {
        ::close(ends[0]);
        ::prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (::getppid() != parent) ::_exit(kFailed);
        const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
        for (int descriptor = 0; descriptor <= STDERR_FILENO; ++descriptor)
            ::dup2(nothing, descriptor);
        run_here(campaign, one, folder, start, ends[1]);
    }
    ::close(ends[1]);
    if (child < 0) {
        ::close(ends[0]);
        throw RunError(fmt::format("no process for a case: {}", std::strerror(errno)));
    }
    const std::string problem = read_all(ends[0]);
    ::close(ends[0]);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
        const std::string how =
            fmt::format("puckloop itself was ended by SIG{}", sigabbrev_np(WTERMSIG(status)));
        if (is_from_outside(WTERMSIG(status))) throw RunError(how);
        if (const std::string full = full_disk(folder); !full.empty()) throw RunError(full);
        throw PuckloopFailed(how);
    }
    if (WEXITSTATUS(status) == kBroke) throw PuckloopFailed("puckloop itself threw: " + problem);
    if (WEXITSTATUS(status) == kRefused) throw InputError("", "", problem);
    if (WEXITSTATUS(status) != 0)
        throw RunError(problem.empty() ? fmt::format("a run ended with status {}", WEXITSTATUS(status))
                                       : problem);
}

Verdict run_case(const Campaign& campaign, const Case& one, const std::filesystem::path& folder,
                 const CaseStart& start, const Profile& nominal) {
    Verdict verdict;
    try {
        execute(campaign, one, folder, start);
        verdict = judge(campaign, nominal, read_profile(folder), one.faults.size());
    } catch (const PuckloopFailed& failure) {
        verdict = failed_verdict(one.faults.size(), failure.what());
    }
    if (verdict.outcome != Outcome::PuckloopFailed || !start.snapshot) return verdict;
    const std::string before = verdict.detail;
    CaseStart whole = start;
    whole.snapshot = nullptr;
    verdict = run_case(campaign, one, folder, whole, nominal);
    if (verdict.outcome == Outcome::PuckloopFailed) return verdict;
    fmt::print(stderr, "puckloop: case {}: from a snapshot puckloop failed ({}): it is run whole\n", one.id,
               before);
    verdict.detail += fmt::format("{}from a snapshot puckloop failed ({}), so it was run whole",
                                  verdict.detail.empty() ? "" : "; ", before);
    return verdict;
}

}  // namespace puckloop::faults
