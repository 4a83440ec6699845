#include "campaigns/engine/worker.h"

#include "base/error.h"
#include "campaigns/engine/case_run.h"
#include "campaigns/engine/plan.h"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <iostream>

#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace puckloop::faults {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path nominal_folder(const fs::path& out, std::uint64_t seed) {
    return out / "nominal" / std::to_string(seed);
}

fs::path boots_folder(const fs::path& out) {
    return out / "boots";
}

fs::path work_folder(const fs::path& out) {
    return out / "work";
}

namespace {

/// One line in one write, so that a kill leaves a line whole or without its end.
void write_line(int descriptor, std::string line) {
    line += '\n';
    std::size_t done = 0;
    while (done < line.size()) {
        const auto count = ::write(descriptor, line.data() + done, line.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) throw RunError(fmt::format("a result cannot be written: {}", std::strerror(errno)));
        done += static_cast<std::size_t>(count);
    }
}

class Runner {
  public:
    explicit Runner(const WorkerTask& task)
        : task_(task),
          campaign_(read_campaign(task.campaign)),
          scenario_(scenario_of(campaign_)),
          prefixes_(task.out) {
        char host[64] = "";
        ::gethostname(host, sizeof host - 1);  // nodes of a cluster share the folder, not process numbers
        folder_ = work_folder(task.out) / fmt::format("{}-{}", host, ::getpid());
    }
    ~Runner() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    Runner(const Runner&) = delete;
    Runner& operator=(const Runner&) = delete;

    json result(const Case& one) {
        try {
            CaseStart start{boots_folder(task_.out)};
            start.snapshot = prefixes_.before(one.seed, first_begin(campaign_, scenario_, one));
            const Verdict verdict = run_case(campaign_, one, folder_, start, nominal(one.seed));
            return {{"id", one.id}, {"verdict", to_json(verdict)}};
        } catch (const std::runtime_error& error) {
            return {{"id", one.id}, {"problem", error.what()}};
        }
    }

  private:
    const Profile& nominal(std::uint64_t seed) {
        const auto found = nominals_.find(seed);
        if (found != nominals_.end()) return found->second;
        return nominals_.emplace(seed, read_profile(nominal_folder(task_.out, seed))).first->second;
    }

    WorkerTask task_;
    Campaign campaign_;
    scenarios::Scenario scenario_;
    Prefixes prefixes_;
    fs::path folder_;
    Nominals nominals_;
};

}  // namespace

void work(const WorkerTask& task) {
    const bool local = task.cases.empty();
    if (local) ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // nothing outlives the campaign
    int out = ::dup(STDOUT_FILENO);
    if (!task.results.empty())
        out = ::open(task.results.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (out < 0)
        throw RunError(fmt::format("{}: cannot be written: {}", task.results.string(), std::strerror(errno)));
    ::fcntl(out, F_SETFD, FD_CLOEXEC);
    std::ifstream file;
    if (!local) {
        file.open(task.cases);
        if (!file) throw InputError(task.cases.string(), "", std::strerror(errno), "cases of a campaign");
    }
    std::istream& in = local ? std::cin : file;
    Runner runner(task);
    std::string line;
    for (int index = 0; std::getline(in, line); ++index)
        if (local || index % task.tasks == task.task)
            write_line(out, runner.result(case_from_json(json::parse(line)))
                                .dump(-1, ' ', false, json::error_handler_t::replace));
    ::close(out);
}

}  // namespace puckloop::faults
