// Boots that are skipped: the run is the same in every byte, whatever the cache holds.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>

#include <sys/stat.h>

using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

/// The small scenario, its board said to boot for `boot`; `from`/`to` change one more word of it.
fs::path scenario(const Workbench& bench, const std::string& boot, const std::string& from = {},
                  const std::string& to = {}) {
    std::string text = text_of(bench.hello());
    const auto replace = [&text](const std::string& old, const std::string& now) {
        const auto at = text.find(old);
        REQUIRE(at != std::string::npos);
        text.replace(at, old.size(), now);
    };
    replace("[robot.pic]\n", "[robot.pic]\nboot = \"" + boot + "\"\n");
    if (!from.empty()) replace(from, to);
    return bench.file("boot.toml", text);
}

/// A cache of the test's own, for the processes that it starts.
class Cache {
  public:
    explicit Cache(const fs::path& folder) : folder_(folder) {
        ::setenv("PUCKLOOP_CACHE", folder.c_str(), 1);
    }
    ~Cache() { ::setenv("PUCKLOOP_CACHE", "off", 1); }
    Cache(const Cache&) = delete;
    Cache& operator=(const Cache&) = delete;

    std::vector<fs::path> files() const {
        std::vector<fs::path> list;
        if (fs::exists(folder_))
            for (const auto& entry : fs::directory_iterator(folder_))
                list.push_back(entry.path());
        return list;
    }

  private:
    fs::path folder_;
};

int mode_of(const fs::path& path) {
    struct stat info {};
    REQUIRE(::stat(path.c_str(), &info) == 0);
    return static_cast<int>(info.st_mode & 0777);
}

Ended run(const Workbench& bench, const std::string& name, const fs::path& file, Words more = {}) {
    Words words{file, "--duration", "4"};
    words.insert(words.end(), more.begin(), more.end());
    Ended ended = bench.run(name, words);
    INFO(ended.err);
    CHECK(ended.status == 0);
    return ended;
}

nlohmann::json resumed(const Workbench& bench, const std::string& name) {
    return bench.report(name)["nodes"]["robot0.pic"].value("resumed", nlohmann::json());
}

}  // namespace

TEST_CASE("a boot from the cache gives the same run in every byte") {
    const Workbench bench;
    const Cache cache(bench.folder() / "cache");
    const fs::path file = scenario(bench, "1 s");
    run(bench, "plain", file, {"--no-cache"});
    CHECK(cache.files().empty());
    run(bench, "first", file);
    REQUIRE(cache.files().size() == 1);
    CHECK(mode_of(bench.folder() / "cache") == 0700);
    CHECK(mode_of(cache.files()[0]) == 0600);
    CHECK(resumed(bench, "first").is_null());
    const Ended second = run(bench, "second", file);
    CHECK_THAT(second.out, Catch::Contains("robot0.pic: boot of 1 s skipped, from cache"));
    CHECK(resumed(bench, "second")["skipped"] == true);
    run(bench, "one", file, {"--in-process"});
    CHECK(resumed(bench, "one")["skipped"] == true);
    CHECK(cache.files().size() == 1);
    for (const char* name : {"first", "second", "one"}) {
        check_same_run(bench, "plain", name);
        CHECK(text_of(bench.out(name) / "robot0.pic.log") == text_of(bench.out("plain") / "robot0.pic.log"));
        auto report = bench.report(name)["nodes"]["robot0.pic"];
        report.erase("resumed");
        CHECK(report == bench.report("plain")["nodes"]["robot0.pic"]);
    }
}

TEST_CASE("a board that receives something else while it boots is executed") {
    const Workbench bench;
    const Cache cache(bench.folder() / "cache");
    // The program speaks while the board boots, in the second run a millisecond later.
    run(bench, "first", scenario(bench, "1 s", "start = \"1 s\"", "start = \"500 ms\""));
    REQUIRE(cache.files().size() == 1);
    const fs::path file = scenario(bench, "1 s", "start = \"1 s\"", "start = \"501 ms\"");
    run(bench, "plain", file, {"--no-cache"});
    const Ended second = run(bench, "second", file);
    CHECK_THAT(second.out, Catch::Contains("robot0.pic: boot executed: it "));
    CHECK_THAT(second.out, Catch::Contains("on port uart2 at 0.50"));
    CHECK(resumed(bench, "second")["skipped"] == false);
    check_same_run(bench, "plain", "second");
    // What it lived through is what the cache has now.
    run(bench, "third", file);
    CHECK(resumed(bench, "third")["skipped"] == true);
    check_same_run(bench, "plain", "third");
    // Another place in the arena is another boot.
    const fs::path moved =
        scenario(bench, "1 s", "position = [\"-10 cm\", \"0 cm\"]", "position = [\"-12 cm\", \"0 cm\"]");
    run(bench, "moved", moved);
    CHECK(resumed(bench, "moved").is_null());
    CHECK(cache.files().size() == 2);
}

TEST_CASE("a damaged or unusable cache costs time only") {
    const Workbench bench;
    const fs::path file = scenario(bench, "1 s");
    run(bench, "plain", file, {"--no-cache"});
    {
        const Cache cache(bench.folder() / "cache");
        run(bench, "first", file);
        REQUIRE(cache.files().size() == 1);
        const std::string whole = text_of(cache.files()[0]);
        for (const std::string& damaged : {std::string(), whole.substr(0, whole.size() / 2), whole + "x"}) {
            std::ofstream(cache.files()[0], std::ios::binary) << damaged;
            run(bench, "next", file);
            CHECK(resumed(bench, "next").is_null());
            check_same_run(bench, "plain", "next");
            const bool kept_again = text_of(cache.files()[0]) == whole;
            CHECK(kept_again);
        }
    }
    for (const fs::path& folder : {fs::path("/proc/puckloop"), bench.file("no_folder", "x")}) {
        const Cache cache(folder);
        const Ended ended = run(bench, "next", file);
        CHECK_THAT(ended.out, Catch::Contains("warning: boot cache " + folder.string()));
        check_same_run(bench, "plain", "next");
    }
}

TEST_CASE("without a home that can be written to, boots are executed and nothing is wrong") {
    const Workbench bench;
    const fs::path file = scenario(bench, "1 s");
    const Cache cache(bench.folder() / "cache");
    ::unsetenv("PUCKLOOP_CACHE");
    const char* old = std::getenv("HOME");
    const std::string home = old ? old : "/";
    ::setenv("HOME", "/proc/nobody", 1);
    const char* xdg = std::getenv("XDG_CACHE_HOME");
    const std::string xdg_home = xdg ? xdg : "";
    ::unsetenv("XDG_CACHE_HOME");
    const Ended quiet = run(bench, "quiet", file, {"--strict"});
    const Ended wordy = run(bench, "wordy", file, {"-v"});
    ::setenv("HOME", home.c_str(), 1);
    if (xdg) ::setenv("XDG_CACHE_HOME", xdg_home.c_str(), 1);
    CHECK(quiet.out.find("cache") == std::string::npos);
    CHECK(quiet.err.empty());
    CHECK_THAT(wordy.err, Catch::Contains("boot cache /proc/nobody/.cache/puckloop: No such file"));
    const auto report = bench.report("quiet");
    CHECK(report["warnings"].empty());
    CHECK_THAT(report["cache_unused"].get<std::string>(), Catch::StartsWith("boot cache /proc/nobody"));
}

TEST_CASE("runs at the same time share a cache") {
    const Workbench bench;
    const Cache cache(bench.folder() / "cache");
    const fs::path file = scenario(bench, "1 s");
    std::vector<std::unique_ptr<Process>> runs;
    for (const char* name : {"a", "b", "c"})
        runs.push_back(bench.start({"run", file, "--duration", "2", "--out", bench.out(name)}));
    for (const auto& one : runs)
        CHECK(one->wait().status == 0);
    check_same_run(bench, "a", "b");
    check_same_run(bench, "a", "c");
    CHECK(cache.files().size() == 1);
}

TEST_CASE("in real time the boot is not waited for") {
    const Workbench bench;
    const Cache cache(bench.folder() / "cache");
    std::string text = text_of(scenario(bench, "45 s"));
    text = text.substr(0, text.find("[robot.linux]"));
    text.insert(text.find("boot = "), "uart1 = \"pty\"\n");
    const fs::path file = bench.file("realtime.toml", text);
    for (const char* name : {"first", "second"}) {
        // 46 s in all: a busy machine has time enough where no process waits for another.
        const Ended ended = bench.run(name, {file, "--realtime", "--in-process", "--duration", "46"});
        INFO(ended.err);
        CHECK(ended.status == 0);
        CHECK(ended.seconds > 0.9);
        CHECK(ended.seconds < 40);
        CHECK_THAT(ended.err, Catch::Contains("the first 45 s are not paced"));
    }
    CHECK(resumed(bench, "second")["skipped"] == true);
    check_same_run(bench, "first", "second");
}

TEST_CASE("a boot before the run begins, or beyond every run, is refused") {
    const Workbench bench;
    for (const char* time : {"-1 s", "1e30 s"})
        check_one_line(bench.run("x", {scenario(bench, time)}), 2, {"boot.toml", "line ", "boot", "720 h"});
}
