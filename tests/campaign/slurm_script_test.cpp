// A campaign and a cluster that is slow to answer, forgets what it did, or holds tasks back. The cluster is
// three shell scripts in place of Slurm's commands: what Slurm does of itself is slurm_test's.

#include "tests/campaign/small_campaign.h"
#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <thread>

using namespace puckloop::tests;
using Catch::Contains;

namespace fs = std::filesystem;

namespace {

/// Stands in front of PATH; files in its folder are what the cluster knows.
class Scripts {
  public:
    explicit Scripts(const Workbench& bench) : folder_(bench.out("scripts")), path_(std::getenv("PATH")) {
        fs::create_directories(folder_);
        ::setenv("PATH", (folder_.string() + ":" + path_).c_str(), 1);
        // A job is in the queue as long as there is a file `job`, in the state that is its content.
        put("squeue", "[ \"$1\" = --version ] && exit 0\n"
                      "if [ -e busy ]; then rm busy; echo Socket timed out >&2; exit 1; fi\n"
                      "[ -e job ] && cat job\nexit 0\n");
        put("scancel", "[ \"$1\" = --version ] && exit 0\n"
                       "[ -e \"$(cat watched)\" ] && touch was_there\nrm -f job\n");
        // The words are: --parsable ... --array 0-LAST ... SCRIPT.
        put("sbatch",
            "[ \"$1\" = --version ] && exit 0\n"
            "if [ -e refuse ]; then mv refuse refused; echo Unable to contact controller >&2; exit 1; fi\n"
            "if [ -e state ]; then mv state job; echo 7; exit 0; fi\n"
            "while [ $# -gt 1 ]; do [ \"$1\" = --array ] && last=${2#0-}; shift; done\n"
            "for task in $(seq 0 $last); do SLURM_ARRAY_TASK_ID=$task sh \"$1\" || exit 1; done\necho 8\n");
    }
    ~Scripts() { ::setenv("PATH", path_.c_str(), 1); }
    Scripts(const Scripts&) = delete;
    Scripts& operator=(const Scripts&) = delete;

    void note(const std::string& name, const std::string& content) const {
        std::ofstream(folder_ / name) << content;
    }
    bool has(const std::string& name) const { return fs::exists(folder_ / name); }

  private:
    void put(const std::string& name, const std::string& text) const {
        note(name, "#!/bin/sh\ncd '" + folder_.string() + "' || exit 1\n" + text);
        fs::permissions(folder_ / name, fs::perms::owner_all);
    }

    fs::path folder_;
    std::string path_;
};

}  // namespace

TEST_CASE("tasks of a campaign that was killed are ended before their folder is cleaned") {
    const Workbench bench;
    const Scripts scripts(bench);
    const auto file = small_campaign(bench);
    const Words words = campaign_words(bench, file, "out", {"--slurm", "--tasks", "2"});
    const fs::path task = bench.out("out") / "work" / "node1-77";  // as of a task on some node
    scripts.note("watched", task.string());
    scripts.note("state", "RUNNING None\n");
    {
        const auto campaign = bench.start(words);
        while (!scripts.has("job") && runs(campaign->id()))
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        REQUIRE(scripts.has("job"));
        campaign->signal(SIGKILL);
        campaign->wait();
    }
    fs::create_directories(task);
    // The controller does not answer once, and a job has to be submitted twice.
    scripts.note("busy", "");
    scripts.note("refuse", "");
    const Ended ended = bench.puckloop(words);
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    CHECK(scripts.has("was_there"));
    CHECK_FALSE(scripts.has("busy"));
    CHECK(scripts.has("refused"));
    CHECK_FALSE(fs::exists(task));
    CHECK(table_of(bench, "out") == reference_table(bench, file));
}

TEST_CASE("tasks that the cluster holds back end a campaign with the reason") {
    const Workbench bench;
    const Scripts scripts(bench);
    scripts.note("watched", "nothing");
    scripts.note("state", "PENDING launch failed requeued held\nPENDING JobHeldAdmin\n");
    const Ended ended =
        bench.puckloop(campaign_words(bench, small_campaign(bench), "out", {"--slurm", "--tasks", "2"}));
    CHECK(ended.status == 1);
    CHECK_THAT(ended.err, Contains("holds the tasks back (JobHeldAdmin)") && Contains("the same command"));
    CHECK_FALSE(scripts.has("job"));
}
