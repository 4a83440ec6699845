// puckloop gap as its users meet it: what cannot be done is said in one line before any work, and what stood
// in a folder is still there afterwards.

#include "base/random.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"
#include "tests/tools/shell.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

using namespace puckloop;
using namespace puckloop::tests;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

void write(const fs::path& file, const std::string& text) {
    fs::create_directories(file.parent_path());
    std::ofstream(file) << text;
}

/// A folder with a small experiment in "floor": four runs of ground sensors.
class Desk {
  public:
    Desk() : path(scratch_path("gap_commands")) {
        fs::remove_all(path);
        RandomStream random(1, "gap commands");
        std::string toml = "kind = \"ground\"\n";
        for (int r = 0; r < 4; ++r) {
            std::string csv = "t_s,sensor,grey,reading\n";
            for (int i = 0; i < 60; ++i)
                csv += fmt::format("{:.1f},{},{},{:.0f}\n", i * 0.1, i % 3, i % 5 / 4.0,
                                   331 + 155 * (i % 5) + 5 * random.normal());
            write(path / fmt::format("floor/run{}.csv", r), csv);
            toml += fmt::format("[[run]]\nfile = \"run{}.csv\"\n", r);
        }
        write(path / "floor/experiment.toml", toml);
    }
    ~Desk() { fs::remove_all(path); }
    Desk(const Desk&) = delete;
    Desk& operator=(const Desk&) = delete;
    std::string at(const std::string& name) const { return (path / name).string(); }

    const fs::path path;
};

void check_refused(const std::string& arguments, const std::string& word) {
    const Ran result = run_puckloop(arguments);
    INFO(arguments << ": " << result.output);
    CHECK(result.status == 2);
    CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
    CHECK_THAT(result.output, Contains(word));
}

}  // namespace

TEST_CASE("gap: options and folders that cannot be used end in one line and status 2") {
    const Desk desk;
    const std::string floor = "gap " + desk.at("floor");
    check_refused(floor + " --seed -1", "--seed");
    check_refused(floor + " --seed 99999999999999999999", "--seed");
    check_refused(floor + " --out ''", "--out");
    check_refused(floor + " --out /dev/full", "/dev/full");
    check_refused(floor + " --out " + desk.at("floor/run0.csv"), "run0.csv");
    check_refused(floor + " --no-rerun --firmware x.hex --out " + desk.at("out"), "--no-rerun");
    check_refused(floor + " --rerun --no-rerun --out " + desk.at("out"), "--no-rerun");
    check_refused(floor + " --firmware x.hex --out " + desk.at("out"), "x.hex: no such file");
    check_refused(floor + " --firmware x.hex", "--out");
    check_refused("gap chek " + desk.at("floor"), "perhaps gap check");
    check_refused("gap new grund " + desk.at("out"), "did you mean \"ground\"?");
    check_refused("gap selftest --emulator --json", "--json: is for made experiments");
    check_refused("gap selftest --emulator --ablation", "--ablation: is for cases drawn from the grammar");
    check_refused("gap record motion --sett robot.axle_length=0.05 --out " + desk.at("out"), "perhaps --set");
    check_refused("gap selftest --workers 99999999", "--workers");
    check_refused("gap selftest --cases -1", "--cases");
    check_refused("gap selftest --quick --kind ground --scratch /dev/full", "/dev/full");
    check_refused("gap record motion --set host.period=0 --out " + desk.at("out"), "host.period");
    check_refused("gap record timing --brief --set uart.loss=0.02 --out " + desk.at("loss"),
                  "--set uart.loss=0.02: recording on the emulator: the main board answered");
    check_refused("gap record rab --set host.rab_poll=-1 --out " + desk.at("out"), "host.rab_poll");
    check_refused("gap record ground --rab-firmware x.hex --out " + desk.at("out"), "--rab-firmware");
    CHECK(!fs::exists(desk.path / "out"));
}

TEST_CASE("gap record: a change that the kind does not show is warned of") {
    const Desk desk;
    const auto unseen =
        run_puckloop("gap record ground --brief --set robot.axle_length=0.054 --out " + desk.at("a"));
    CHECK(unseen.status == 0);
    CHECK_THAT(unseen.output,
               Contains("warning: --set robot.axle_length=0.054: a recording of ground does not show "
                        "robot.axle_length; kinds that do: motion"));
    const auto seen = run_puckloop("gap record ground --brief --set ground.gain1=0.9 --out " + desk.at("b"));
    CHECK(seen.status == 0);
    CHECK_THAT(seen.output, !Contains("warning"));
    // What is too short for a verdict is called that in the verdict.
    const auto verdict = run_puckloop("gap " + desk.at("b") + " --no-rerun --out " + desk.at("verdict"));
    CHECK(verdict.status == 0);
    CHECK_THAT(verdict.output, Contains("caution: this is a brief recording") && Contains("verdict: "));
    std::ifstream json(desk.path / "verdict" / "gap.json");
    const std::string text{std::istreambuf_iterator<char>(json), {}};
    CHECK_THAT(text, Contains("this is a brief recording"));
}

TEST_CASE("gap: -v says each step in the host's log, a bad level is refused") {
    const Desk desk;
    const std::string floor = "gap " + desk.at("floor");
    const Ran result = run_puckloop(floor + " -v");
    CHECK(result.status == 0);
    CHECK_THAT(result.output, Contains(" info    [gap ") && Contains("] read " + desk.at("floor")) &&
                                  Contains("] analysed in "));
    CHECK_THAT(run_puckloop(floor).output, !Contains("[gap "));
    check_refused(floor + " --log-level loud", "--log-level");
    check_refused(floor + " --log-file " + desk.at("nowhere/log"), "nowhere/log");
}

TEST_CASE("gap: what cannot be written leaves the old verdict whole") {
    const Desk desk;
    const fs::path out = desk.path / "out";
    REQUIRE(run_puckloop("gap " + desk.at("floor") + " --out " + out.string()).status == 0);
    const std::string json = text_of(out / "gap.json"), overlay = text_of(out / "overlay.toml");
    CHECK(json.size() > 100);
    // Killed while the page is written: it is longer than any file may be, the other two are not.
    const std::string command = fmt::format("(ulimit -f 16; {} gap {} --seed 2 --out {}) >/dev/null 2>&1",
                                            PUCKLOOP_PROGRAM, desk.at("floor"), out.string());
    CHECK(std::system(command.c_str()) != 0);
    CHECK(text_of(out / "gap.json") == json);
    CHECK(text_of(out / "overlay.toml") == overlay);
    fs::remove(out / "report.html");
    fs::create_directories(out / "report.html");
    check_refused("gap " + desk.at("floor") + " --out " + out.string(), "is a folder");
}

TEST_CASE("gap: what a killed analysis left half written is cleared away, other files are not") {
    const Desk desk;
    constexpr int kGone = 999999999, kLives = 1;  // no process has the one, the first of all has the other
    const fs::path out = desk.path / "out";
    const auto rest = [&](const char* name, int process) {
        return out / fmt::format("{}.{}.part", name, process);
    };
    write(rest("gap.json", kGone), "{");
    write(rest("gap.json", kLives), "{");
    write(out / fmt::format("rerun.{}/run1/report.json", kGone), "{}");
    write(out / "notes.part", "mine");
    CHECK(run_puckloop("gap " + desk.at("floor") + " --no-rerun --out " + out.string()).status == 0);
    CHECK_FALSE(fs::exists(rest("gap.json", kGone)));
    CHECK_FALSE(fs::exists(out / fmt::format("rerun.{}", kGone)));
    CHECK(fs::exists(rest("gap.json", kLives)));
    CHECK(fs::exists(out / "notes.part"));
    CHECK(fs::exists(out / "gap.json"));
}

TEST_CASE("gap: nothing of a laboratory's is written over or removed") {
    const Desk desk;
    const std::string before = text_of(desk.path / "floor/experiment.toml");
    check_refused("gap record ground --brief --out " + desk.at("floor"), "there already");
    CHECK(text_of(desk.path / "floor/experiment.toml") == before);

    write(desk.path / "scratch/case000/notes.txt", "precious");
    check_refused("gap selftest --quick --kind ground --case 18 --scratch " + desk.at("scratch"),
                  "notes.txt");
    CHECK(text_of(desk.path / "scratch/case000/notes.txt") == "precious");

    check_refused("gap import " + desk.at("floor") + " --set unifr_epuck2_timing --out " + desk.at("made"),
                  "holds");
    CHECK(!fs::exists(desk.path / "made"));
}
