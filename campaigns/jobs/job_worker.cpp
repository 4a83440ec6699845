#include "campaigns/jobs/job_worker.h"

#include "base/error.h"
#include "campaigns/jobs/isolated.h"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>

#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

namespace puckloop::jobs {

using nlohmann::json;

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

json result_of(const json& job, const std::function<json(const json&)>& carry_out) {
    const int id = job.at("id");
    try {
        return {{"id", id}, {"verdict", carry_out(job)}};
    } catch (const Killed& killed) {
        return {{"id", id}, {"problem", killed.what()}, {"killed", true}};
    } catch (const std::runtime_error& error) {
        return {{"id", id}, {"problem", error.what()}};
    }
}

}  // namespace

void work(const WorkerTask& task, const std::function<json(const json& job)>& carry_out) {
    const bool local = task.jobs.empty();
    if (local) ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // nothing outlives who started it
    int out = ::dup(STDOUT_FILENO);
    if (!task.results.empty())
        out = ::open(task.results.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (out < 0)
        throw RunError(fmt::format("{}: cannot be written: {}", task.results.string(), std::strerror(errno)));
    ::fcntl(out, F_SETFD, FD_CLOEXEC);
    std::ifstream file;
    if (!local) {
        file.open(task.jobs);
        if (!file) throw InputError(task.jobs.string(), "", std::strerror(errno), "jobs, one per line");
    }
    std::istream& in = local ? std::cin : file;
    std::string line;
    for (int index = 0; std::getline(in, line); ++index)
        if (local || index % task.tasks == task.task)
            write_line(
                out,
                result_of(json::parse(line), carry_out).dump(-1, ' ', false, json::error_handler_t::replace));
    ::close(out);
}

std::filesystem::path own_folder(const std::filesystem::path& parent) {
    char host[64] = "";
    ::gethostname(host, sizeof host - 1);  // nodes of a cluster share the folder, not process numbers
    return parent / fmt::format("{}-{}", host, ::getpid());
}

}  // namespace puckloop::jobs
