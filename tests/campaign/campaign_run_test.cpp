// A whole campaign: the same table with any number of workers, after kills, and on a disk that was full.

#include "base/random.h"
#include "campaigns/engine/store.h"
#include "tests/campaign/small_campaign.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <thread>

#include <sys/mount.h>
#include <unistd.h>

using namespace puckloop;
using namespace puckloop::tests;
using Catch::Contains;

namespace {

std::size_t results_in(const std::filesystem::path& out) {
    try {
        return faults::Store(out / "campaign.db", faults::Store::Access::Read).results().size();
    } catch (const std::exception&) {
        return 0;  // not there yet
    }
}

/// False if the campaign ended before.
bool wait_for_results(const Process& campaign, const std::filesystem::path& out, std::size_t count) {
    while (results_in(out) < count) {
        if (!runs(campaign.id())) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
}

std::size_t rows_of(const std::string& table) {
    return static_cast<std::size_t>(std::count(table.begin(), table.end(), '\n')) - 1;
}

void two_workers(const Workbench& bench, const std::filesystem::path& file, const std::string& table) {
    // Every case whole; the reference's went on from snapshots.
    const Ended whole = bench.puckloop(campaign_words(bench, file, "two", {"--jobs", "2", "--no-snapshots"}));
    REQUIRE(whole.status == 0);
    CHECK_THAT(whole.err, !Contains("saved at"));
    CHECK_FALSE(std::filesystem::exists(bench.out("two") / "snapshots"));
    CHECK(std::filesystem::exists(bench.out("reference") / "snapshots"));
    CHECK(table_of(bench, "two") == table);
    // Once more in the same folder: nothing is left to run.
    const Ended again = bench.puckloop(campaign_words(bench, file, "two"));
    CHECK(again.status == 0);
    CHECK_THAT(again.err, Contains(", 0 run now"));
    CHECK(table_of(bench, "two") == table);
}

/// It goes on without losing or repeating a case.
void killed(const Workbench& bench, const std::filesystem::path& file, const std::string& table) {
    RandomStream random(Catch::rngSeed(), "campaign kill");
    const std::size_t after = 1 + random.below(7);
    CAPTURE(after);
    {
        const auto campaign = bench.start(campaign_words(bench, file, "killed", {"--jobs", "2"}));
        REQUIRE(wait_for_results(*campaign, bench.out("killed"), after));
        const std::vector<pid_t> workers = campaign->children();
        campaign->signal(SIGKILL);
        campaign->wait();
        CHECK(all_end(workers));
    }
    const std::size_t kept = results_in(bench.out("killed"));
    CHECK(kept >= after);
    const Ended rest = bench.puckloop(campaign_words(bench, file, "killed", {"--jobs", "2"}));
    INFO(rest.err);
    REQUIRE(rest.status == 0);
    CHECK(table_of(bench, "killed") == table);
    // Of the singles only the missing ones were run.
    const std::size_t singles = 10;
    if (kept <= singles) CHECK_THAT(rest.err, Contains(fmt::format("{} run now", singles - kept)));
    CHECK(rows_of(table) == results_in(bench.out("killed")) + 2);  // and two that were pruned
}

std::size_t failures_in(const std::filesystem::path& out) {
    try {
        const auto results = faults::Store(out / "campaign.db", faults::Store::Access::Read).results();
        return static_cast<std::size_t>(std::count_if(results.begin(), results.end(), [](const auto& one) {
            return one.verdict.outcome == faults::Outcome::PuckloopFailed;
        }));
    } catch (const std::exception&) {
        return 0;  // not there yet
    }
}

/// They are replaced and their cases run again.
void workers_die(const Workbench& bench, const std::filesystem::path& file, const std::string& table) {
    const auto campaign = bench.start(campaign_words(bench, file, "lost", {"--jobs", "2"}));
    REQUIRE(wait_for_results(*campaign, bench.out("lost"), 1));
    const std::vector<pid_t> workers = campaign->children();
    REQUIRE(!workers.empty());
    for (const pid_t worker : workers)
        ::kill(worker, SIGKILL);
    const Ended ended = campaign->wait();
    INFO(ended.err);
    CHECK(ended.status == 0);
    CHECK_THAT(ended.err, Contains("died (SIGKILL): it is run again"));
    CHECK(table_of(bench, "lost") == table);
}

/// It stops the campaign, and the rest is run when there is room.
void full_disk(const Workbench& bench, const std::filesystem::path& file, const std::string& table) {
    const auto disk = bench.out("disk");
    std::filesystem::create_directory(disk);
    if (::geteuid() != 0 || ::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=900k") != 0) {
        WARN("skipped: only root can mount a small disk");
        return;
    }
    const Words words{"faults", "campaign", file.string(), "--out", (disk / "out").string(), "--jobs", "2"};
    const Ended full = bench.puckloop(words);
    INFO(full.err);
    CHECK(full.status == 1);
    CHECK_THAT(full.err, Contains("No space left") || Contains("full"));
    // Full again somewhere in the cases: what a node cannot write is no outcome of its fault.
    for (std::uint64_t room = 1000; room < 2200; room += 200) {
        REQUIRE(::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, fmt::format("size={}k", room).c_str()) ==
                0);
        CHECK(bench.puckloop(words).status <= 1);
    }
    REQUIRE(::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=64m") == 0);
    const Ended rest = bench.puckloop(words);
    INFO(rest.err);
    CHECK(rest.status == 0);
    CHECK(text_of(disk / "out" / "results.csv") == table);
    REQUIRE(::umount(disk.c_str()) == 0);
}

void replay(const Workbench& bench, const std::string& table) {
    const std::string out = bench.out("reference").string();
    // The finding's own command, from the summary.
    const Ended shown = bench.puckloop({"faults", "show", out});
    REQUIRE(shown.status == 0);
    const auto place = shown.out.find("puckloop faults replay ");
    REQUIRE(place != std::string::npos);
    const std::string line = shown.out.substr(place, shown.out.find('\n', place) - place);
    const std::string number = line.substr(line.rfind(' ') + 1);
    const Ended again =
        bench.puckloop({"faults", "replay", out, number, "--out", bench.out("again").string()});
    INFO(again.out << again.err);
    CHECK(again.status == 0);
    const auto report = bench.report("again");
    CHECK_THAT(table, Contains(report["trace_sha256"].get<std::string>()));
    CHECK_THAT(again.out, Contains("[[fault]]") && Contains("replayed: hang"));
    // The same without the campaign, as `show` gives it.
    const Ended one = bench.puckloop({"faults", "show", out, number});
    const std::string run = one.out.substr(one.out.find("puckloop run ") + 9);
    const std::string shell = std::string(PUCKLOOP_PROGRAM) + " " + run.substr(0, run.find('\n')) +
                              " --out " + bench.out("alone").string();
    Process alone({"/bin/sh", "-c", shell}, bench.folder());
    CHECK(alone.wait().status == 0);
    CHECK(bench.report("alone")["trace_sha256"] == report["trace_sha256"]);
    const Ended unknown = bench.puckloop({"faults", "show", out, "4000"});
    CHECK(unknown.status == 2);
    // The tables can be made again from the database alone.
    std::filesystem::remove(bench.out("reference") / "results.csv");
    CHECK(bench.puckloop({"faults", "report", out}).status == 0);
    CHECK(table_of(bench, "reference") == table);
}

/// As the report has it, in a shell of another folder and without the campaign's environment.
void replay_from_report(const Workbench& bench) {
    const std::string html = text_of(bench.out("reference") / "report.html");
    const std::string mark = "<code class=copy>";
    const auto place = html.find(mark);
    REQUIRE(place != std::string::npos);
    const std::string command =
        html.substr(place + mark.size(), html.find("</code>", place) - place - mark.size());
    INFO(command);
    Process shell({"/bin/sh", "-c", "unset PUCKLOOP_TEST_IMAGES; " + command}, "/");
    const Ended ended = shell.wait();
    INFO(ended.out << ended.err);
    CHECK(ended.status == 0);
    CHECK_THAT(ended.out, Contains("replayed: "));
}

}  // namespace

TEST_CASE("a small campaign has every outcome that its faults must have") {
    const Workbench bench;
    const auto file = small_campaign(bench);
    const std::string table = reference_table(bench, file);
    INFO(table);
    // Byte 500 of a record is nowhere in the nominal run.
    CHECK_THAT(table, Contains(",byte 500,") && Contains("pruned"));
    // A cable that is pulled for good silences the board; one that comes back does not.
    CHECK_THAT(table, Contains("end=9s,1,hang"));
    CHECK_THAT(table, !Contains("end=1.6s,1,hang"));
    CHECK_THAT(table, Contains("pair"));
    const std::string report = text_of(bench.out("reference") / "report.html");
    CHECK_THAT(report, Contains("class=heat") && Contains("faults replay") && Contains("</html>") &&
                           !Contains("<script"));
    // What a sweep varies is distinguished in its map, counts too.
    CHECK_THAT(report, Contains("drop on robot0.uart from robot0.linux count=1</th>") &&
                           Contains("drop on robot0.uart from robot0.linux count=6</th>"));
    replay(bench, table);
    replay_from_report(bench);
}

TEST_CASE("a case in which the emulator itself crashes is an outcome of its own, and the others are run") {
    const Workbench bench;
    const auto file = small_campaign(bench);
    const auto campaign = bench.start(campaign_words(bench, file, "crashing", {"--jobs", "1"}));
    REQUIRE(wait_for_results(*campaign, bench.out("crashing"), 1));
    // The runs of cases are the workers' children; one that goes on from a snapshot is run whole after that.
    while (failures_in(bench.out("crashing")) == 0 && runs(campaign->id()))
        for (const pid_t worker : campaign->children())
            for (const pid_t run : children_of(worker))
                ::kill(run, SIGSEGV);
    const Ended ended = campaign->wait();
    INFO(ended.err);
    CHECK(ended.status == 0);
    CHECK_THAT(ended.err, Contains("puckloop itself failed"));
    CHECK_THAT(ended.out, Contains("puckloop failed"));
    const std::string table = table_of(bench, "crashing");
    INFO(table);
    CHECK_THAT(table, Contains(",puckloop failed,") && Contains("puckloop itself was ended by SIGSEGV"));
    // No case is missing, and each row has as many cells.
    CHECK(rows_of(table) >= 10);
    CHECK_THAT(text_of(bench.out("crashing") / "report.html"), Contains(">puckloop failed<"));
    const std::string failed = table.substr(table.find(",puckloop failed,"));
    CHECK(std::count(failed.begin(), failed.begin() + static_cast<std::ptrdiff_t>(failed.find('\n')), ',') >=
          7);
}

TEST_CASE(
    "runs that are killed from outside are tried again, the nominal one too, and one at last fails alone") {
    const Workbench bench;
    const auto file = small_campaign(bench);
    // The nominal run is the first child of the campaign itself; once is an accident.
    const auto campaign = bench.start(campaign_words(bench, file, "killed", {"--jobs", "1"}));
    std::vector<pid_t> nominal;
    while (nominal.empty() && runs(campaign->id()))
        nominal = campaign->children();
    REQUIRE_FALSE(nominal.empty());
    ::kill(nominal.front(), SIGKILL);
    // Then runs of cases, until one was killed each time.
    REQUIRE(wait_for_results(*campaign, bench.out("killed"), 1));
    while (failures_in(bench.out("killed")) == 0 && runs(campaign->id()))
        for (const pid_t worker : campaign->children())
            for (const pid_t run : children_of(worker))
                ::kill(run, SIGKILL);
    const Ended ended = campaign->wait();
    INFO(ended.err);
    CHECK(ended.status == 0);
    CHECK_THAT(ended.err,
               Contains("nominal run, seed 1: puckloop itself was ended by SIGKILL: it is run again"));
    CHECK_THAT(table_of(bench, "killed"),
               Contains(",puckloop failed,") && Contains("its process died three times"));
    CHECK(rows_of(table_of(bench, "killed")) >= 10);
}

TEST_CASE("a campaign's table is the same with more workers, after a kill, lost workers and a full disk") {
    const Workbench bench;
    const auto file = small_campaign(bench);
    const std::string table = reference_table(bench, file);
    two_workers(bench, file, table);
    killed(bench, file, table);
    workers_die(bench, file, table);
    full_disk(bench, file, table);
}
