// The same campaign on a real Slurm cluster: the same table, after a kill, too.

#include "campaigns/engine/store.h"
#include "tests/campaign/slurm_cluster.h"
#include "tests/campaign/small_campaign.h"
#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

using namespace puckloop;
using namespace puckloop::tests;
using Catch::Contains;

TEST_CASE("a job array makes the table of one worker, after a kill, too") {
    const Workbench bench;
    const SlurmCluster cluster(bench.out("cluster"));
    if (!cluster.missing().empty()) {
        WARN("skipped: " + cluster.missing());
        return;
    }
    const auto file = small_campaign(bench);
    const std::string table = reference_table(bench, file);
    const Words words = campaign_words(bench, file, "slurm", {"--slurm", "--tasks", "2"});
    {
        // Killed when the first results are in; tasks go on meanwhile and are ended by the next start.
        const auto campaign = bench.start(words);
        for (bool any = false; !any && runs(campaign->id());) {
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
            try {
                any = !faults::Store(bench.out("slurm") / "campaign.db", faults::Store::Access::Read)
                           .results()
                           .empty();
            } catch (const std::exception&) {
            }
        }
        campaign->signal(SIGKILL);
        campaign->wait();
    }
    const Ended ended = bench.puckloop(words);
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    CHECK_THAT(ended.err, Contains("single: 12 cases") && !Contains("10 run now"));
    CHECK(table_of(bench, "slurm") == table);
}

TEST_CASE("a cluster where there is no Slurm is refused in one line") {
    const Workbench bench;
    const auto file = small_campaign(bench);
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", bench.folder().c_str(), 1);
    const Ended ended = bench.puckloop(campaign_words(bench, file, "none", {"--slurm"}));
    ::setenv("PATH", path.c_str(), 1);
    check_one_line(ended, 2, {"--slurm", "sbatch"});
}
