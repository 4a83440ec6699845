#include "campaigns/jobs/slurm.h"

#include "base/error.h"
#include "base/files/text_file.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace puckloop::jobs {

namespace fs = std::filesystem;

namespace {

constexpr int kRounds = kTries;
constexpr useconds_t kPoll = 500'000;  ///< us between questions to the controller
constexpr int kPatience = 10;          ///< questions in a row without an answer

struct Reply {
    int status = 127;
    std::string text;  ///< standard output and error
};

/// Runs a Slurm command and waits for it.
Reply ask(std::vector<std::string> words) {
    std::array<int, 2> ends{};
    if (::pipe(ends.data()) != 0) throw RunError(fmt::format("no pipe: {}", std::strerror(errno)));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", 0, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    posix_spawn_file_actions_addclose(&actions, ends[1]);
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t id = -1;
    const int error = ::posix_spawnp(&id, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    Reply reply;
    if (error == 0) {
        std::array<char, 4096> part{};
        for (;;) {
            const auto count = ::read(ends[0], part.data(), part.size());
            if (count < 0 && errno == EINTR) continue;
            if (count <= 0) break;
            reply.text.append(part.data(), static_cast<std::size_t>(count));
        }
        int status = 0;
        while (::waitpid(id, &status, 0) < 0 && errno == EINTR) {
        }
        reply.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    ::close(ends[0]);
    while (!reply.text.empty() && reply.text.back() == '\n')
        reply.text.pop_back();
    return reply;
}

/// One name for all jobs of a results folder.
std::string job_name(const fs::path& out) {
    std::uint64_t hash = 14695981039346656037ull;  // FNV-1a
    for (const char letter : out.string())
        hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211ull;
    return fmt::format("puckloop-{:016x}", hash);
}

fs::path folder_of(const SlurmOptions& options) {
    return options.out / "slurm";
}

/// A line a task that waits or runs: its state and why it waits. A controller that is too busy to answer is
/// asked again.
std::string tasks_left(const std::string& name) {
    for (int tries = 1;; ++tries) {
        const Reply reply = ask({"squeue", "--noheader", "--array", "--name", name, "--format", "%T %r"});
        if (reply.status == 0) return reply.text;
        if (tries == kPatience) throw RunError(fmt::format("squeue: {}", reply.text));
        ::usleep(kPoll);
    }
}

bool any_left(const std::string& name) {
    return !tasks_left(name).empty();
}

/// Why none of them will ever run by itself, such as "launch failed requeued held"; empty if that is not so.
std::string held_back(const std::string& tasks) {
    std::istringstream lines(tasks);
    std::string line, why;
    while (std::getline(lines, line)) {
        if (!line.starts_with("PENDING") || line.find("eld") == std::string::npos) return {};
        why = line.substr(line.find(' ') + 1);
    }
    return why;
}

void end_jobs(const std::string& name) {
    ask({"scancel", "--name", name});
    while (any_left(name))
        ::usleep(kPoll);
}

/// Hands over whole lines of all result files from where the last call stopped.
class Collector {
  public:
    Collector(fs::path folder, const TakeResult& take) : folder_(std::move(folder)), take_(take) {}

    void collect() {
        std::set<fs::path> files;
        for (const auto& entry : fs::directory_iterator(folder_))
            if (entry.path().extension() == ".results") files.insert(entry.path());
        for (const fs::path& path : files) {
            std::ifstream in(path, std::ios::binary);
            std::streamoff& read = read_[path];
            in.seekg(read);
            std::string line;
            while (std::getline(in, line) && !in.eof()) {  // a line without its end is not whole
                read += static_cast<std::streamoff>(line.size()) + 1;
                const nlohmann::json result = nlohmann::json::parse(line, nullptr, false);
                if (result.is_discarded()) continue;
                const int id = result.at("id");
                if (result.contains("problem"))
                    problems[id] = {result.at("problem"), result.value("killed", false)};
                else if (got.insert(id).second)
                    take_(id, result.at("verdict"));
            }
        }
    }

    std::set<int> got;
    struct Problem {
        std::string why;
        bool killed = false;  ///< its process died
    };
    std::map<int, Problem> problems;

  private:
    fs::path folder_;
    const TakeResult& take_;
    std::map<fs::path, std::streamoff> read_;
};

void clean(const fs::path& folder) {
    std::error_code error;
    fs::remove_all(folder, error);
    make_folder(folder);
}

/// A word that a shell takes as it is.
std::string quoted(const std::string& word) {
    std::string text = "'";
    for (const char letter : word)
        text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    return text + "'";
}

void submit(const SlurmOptions& options, const std::vector<Job>& jobs, int round) {
    const fs::path folder = folder_of(options), script = folder / "task.sh";
    std::string list;
    for (const Job& one : jobs)
        list += one.what.dump() + "\n";
    const fs::path file = folder / fmt::format("{}.cases", round);
    write_file(file, list);
    const int tasks = std::min(options.tasks, static_cast<int>(jobs.size()));
    std::string command = quoted(fs::read_symlink("/proc/self/exe").string());
    for (const std::string& word : options.crew.words)
        command += " " + quoted(word);
    write_file(script,
               fmt::format("#!/bin/sh\nexec {} --cases {} --results {}/{}-$SLURM_ARRAY_TASK_ID.results "
                           "--task $SLURM_ARRAY_TASK_ID --tasks {}\n",
                           command, quoted(file.string()), quoted(folder.string()), round, tasks));
    const std::string name = job_name(options.out);
    for (int tries = 1;; ++tries) {
        const Reply reply =
            ask({"sbatch", "--parsable", "--job-name", name, "--array", fmt::format("0-{}", tasks - 1),
                 "--ntasks", "1", "--cpus-per-task", "1", "--output", (folder / "%A_%a.log").string(),
                 "--open-mode", "append", script.string()});
        // An answer that came too late was none, but the tasks are there.
        if (reply.status == 0 || any_left(name)) return;
        if (tries == kRounds) throw RunError(fmt::format("sbatch: {}", reply.text));
    }
}

}  // namespace

void check_slurm() {
    for (const char* program : {"sbatch", "squeue", "scancel"})
        if (ask({program, "--version"}).status != 0)
            throw InputError("", "--slurm", fmt::format("{} cannot be run", program),
                             "a machine that submits to a Slurm cluster (Debian: slurm-client)");
}

void end_tasks(const SlurmOptions& options) {
    if (!fs::exists(folder_of(options))) return;
    check_slurm();
    end_jobs(job_name(options.out));
}

void resume_slurm(const SlurmOptions& options, const TakeResult& take) {
    if (!fs::exists(folder_of(options))) return;
    end_tasks(options);
    Collector(folder_of(options), take).collect();
}

void run_slurm(const SlurmOptions& options, const std::vector<Job>& jobs, const TakeResult& take) {
    const std::string name = job_name(options.out);
    clean(folder_of(options));
    Collector collector(folder_of(options), take);
    std::vector<Job> left = jobs;
    for (int round = 0; round < kRounds && !left.empty(); ++round) {
        submit(options, left, round);
        for (std::string tasks = tasks_left(name); !tasks.empty(); tasks = tasks_left(name)) {
            collector.collect();
            if (const std::string why = held_back(tasks); !why.empty()) {
                end_jobs(name);
                collector.collect();
                throw RunError(fmt::format(
                    "the cluster holds the tasks back ({}); the results so far are kept, the same command "
                    "goes on",
                    why));
            }
            if (options.interrupted != nullptr && *options.interrupted != 0) {
                end_jobs(name);
                collector.collect();
                throw RunError("interrupted; the results so far are kept, the same command goes on");
            }
            ::usleep(kPoll);
        }
        collector.collect();
        std::erase_if(left, [&](const Job& one) { return collector.got.contains(one.id); });
    }
    std::erase_if(left, [&](const Job& one) {
        const auto problem = collector.problems.find(one.id);
        if (!options.deadly || problem == collector.problems.end() || !problem->second.killed) return false;
        take(one.id, options.deadly(one, fmt::format("its process died three times, the last so: {}",
                                                     problem->second.why)));
        return true;
    });
    if (left.empty()) {
        std::error_code ignored;
        fs::remove_all(folder_of(options), ignored);
        return;
    }
    const auto problem = collector.problems.find(left.front().id);
    throw RunError(
        fmt::format("{} {}: {}; the results so far are kept, the same command goes on", options.crew.noun,
                    left.front().id,
                    problem != collector.problems.end()
                        ? problem->second.why
                        : fmt::format("no task brought it (logs in {})", folder_of(options).string())));
}

}  // namespace puckloop::jobs
