// Faults of radio and IRcom in a whole run: a coordinator, a TAM, a robot in it and two that talk outside.
// Every kind fires, does what it states, and is the same however the run is executed.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/end_to_end/tam/tam_visits.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <set>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

std::string robot(const std::string& name, const std::string& place, const std::string& word) {
    return "[[robot]]\nname = \"" + name + "\"\n" + place +
           "[robot.pic]\nfirmware = \"" PUCKLOOP_SOURCE
           "/firmware/epuck/epuck_ircom.hex\"\n[robot.linux]\nprogram = [\"puckloop-control\", "
           "\"--behaviour\", "
           "\"still\", \"--ircom-send\", \"" +
           word + "\", \"--ircom-every\", \"0.4\", \"--duration\", \"9\"]\nstart = \"250 ms\"\n";
}

std::string scenario() {
    return "[run]\nduration = \"7 s\"\nseed = 3\nideal_linux_clocks = true\n[arena]\nsize = [\"1.2 m\", \"90 "
           "cm\"]\n"
           "[[tam]]\nname = \"tam0\"\nposition = [\"30 cm\", \"20 cm\"]\nheading = \"-90 deg\"\n"
           "[coordinator]\nprogram = [\"puckloop-coordinator\", \"--experiment\", \"random-task\", "
           "\"--durations\", \"1,1\", \"--dead-time\", \"1\", \"--words\", \"17,34\"]\nstart = \"0.5 "
           "s\"\nparameters = { NT = 32 }\n" +
           robot("robot0", "position = [\"-30 cm\", \"0 cm\"]\nheading = \"20 deg\"\n", "0x11") +
           robot("robot1", "position = [\"-20 cm\", \"4 cm\"]\nheading = \"210 deg\"\n", "0x22") +
           robot("robot2", "position = [\"30 cm\", \"20 cm\"]\nheading = \"88 deg\"\n", "0x33");
}

const Words kAir{
    // Between a module and its air.
    "drop link=tam0.radio from=ether begin=3s count=1 name=lost",
    "flip link=coordinator.radio from=ether skip=2 count=1 bits=4 name=flipped",
    "duplicate link=coordinator.radio from=ether begin=3s count=1 name=doubled",
    "delay link=tam0.radio from=tam0.xbee delay=20ms jitter=5ms begin=2.5s count=2 name=late",
    "swap link=coordinator.radio from=coordinator.xbee skip=2 count=1 name=swapped",
    // On air.
    "loss node=ether from=tam0 to=coordinator frame=data count=2 name=unheard",
    "loss node=ether frame=mac_ack count=1 begin=3s name=ack",
    "corrupt node=ether bits=7 begin=2s probability=0.2 name=spoilt",
    "clash node=ether begin=3s end=6s load=0.6 dbm=-30 name=foreign",
    // Words of light.
    "loss node=ircom from=robot2 to=tam0 skip=4 count=1 name=word_lost",
    "corrupt node=ircom from=robot0 to=robot1 count=1 name=word_spoilt",
    "flip node=ircom from=robot1 skip=2 count=1 bit=7 name=word_flipped",
    "jitter node=ircom from=robot0 skip=2 count=1 jitter=100us name=word_jitters",
    "delay node=ircom from=robot1 skip=4 count=1 delay=150ms name=word_late",
    "duplicate node=ircom from=tam0 skip=2 count=2 delay=50ms name=word_twice",
    "swap node=ircom from=robot0 skip=4 count=1 name=word_swapped",
    "clash node=ircom to=tam0 from=robot2 skip=6 count=1 name=word_clash",
};

Words with_faults(const std::filesystem::path& file, const Words& faults, const Words& more) {
    Words words{file, "--in-process", "--no-cache"};
    for (const std::string& fault : faults) {
        words.push_back("--fault");
        words.push_back(fault);
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

int count(const nlohmann::json& report, const std::string& name) {
    for (const auto& fault : report["faults"])
        if (fault["name"] == name) return fault["fired"];
    return -1;
}

}  // namespace

TEST_CASE(
    "every fault of radio and IRcom fires on real traffic and says on what, placement changes nothing") {
    const Workbench bench;
    const auto file = bench.file("air.toml", scenario());
    const Ended plain = bench.run("plain", with_faults(file, {}, {"--threads", "1"}));
    INFO(plain.err);
    REQUIRE(plain.status == 0);
    const Ended ended = bench.run("one", with_faults(file, kAir, {"--threads", "1"}));
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const auto report = bench.report("one"), before = bench.report("plain");
    for (const auto& fault : report["faults"]) {
        CAPTURE(fault.dump());
        CHECK(fault["fired"] > 0);
        CHECK_FALSE(fault["firings"].empty());
    }
    // What the modules saw of it.
    const auto& nodes = report["nodes"];
    CHECK(nodes["coordinator.xbee"]["air"]["bad_frames"]["check"] == 1);
    CHECK_FALSE(before["nodes"]["coordinator.xbee"]["air"]["bad_frames"].contains("check"));
    const auto mac = [](const nlohmann::json& of, const char* station, const char* what) {
        return of["nodes"]["ether"]["stations"][station]["mac"][what].get<int>();
    };
    CHECK(mac(report, "tam0", "retries") >= 3);
    CHECK(mac(report, "tam0", "retries") + mac(report, "coordinator", "retries") >
          mac(before, "tam0", "retries") + mac(before, "coordinator", "retries"));
    CHECK(mac(report, "tam0", "received_twice") + mac(report, "coordinator", "received_twice") >= 1);
    CHECK(mac(report, "tam0", "noise") + mac(report, "coordinator", "noise") ==
          count(report, "unheard") + count(report, "ack") + count(report, "spoilt"));
    // The trace marks what happened on links; faults.csv has all of them.
    std::set<std::string> marks, names;
    for (const Row& row : bench.csv("one", "trace.csv"))
        if (row.at("link").ends_with(".radio")) marks.insert(row.at("fault"));
    for (const char* mark : {"drop", "flip", "duplicate", "delay", "held", "swap"})
        CHECK(marks.contains(mark));
    for (const Row& row : bench.csv("one", "faults.csv"))
        names.insert(row.at("fault"));
    CHECK(names.size() == kAir.size());
    // What the trace cannot mark is read from there, one line a firing.
    std::size_t unmarked = 0;
    for (const Row& row : bench.csv("one", "faults.csv"))
        unmarked += row.at("from").empty() ? 1 : 0;
    const Ended decoded =
        bench.puckloop({"trace", "decode", bench.out("one").string(), "--protocol", "fault", "--errors"});
    CHECK(decoded.status == 0);
    CHECK(static_cast<std::size_t>(std::count(decoded.out.begin(), decoded.out.end(), '\n')) == unmarked);
    CHECK_THAT(decoded.out, Contains(" ether ether fault: loss: data from tam0 to coordinator") &&
                                Contains(" ircom ircom fault: duplicate: a word from tam0"));

    const Ended four = bench.run("four", with_faults(file, kAir, {"--threads", "4"}));
    REQUIRE(four.status == 0);
    check_same_run(bench, "one", "four");
    Words own = with_faults(file, kAir, {});
    own.erase(std::find(own.begin(), own.end(), "--in-process"));
    REQUIRE(bench.run("own", own).status == 0);
    check_same_run(bench, "one", "own");
    CHECK(bench.report("own")["faults"] == report["faults"]);
}

TEST_CASE("a fault of the air that never fires fails the run, unless it may, one that cannot be is refused") {
    const Workbench bench;
    const auto file = bench.file("air.toml", scenario());
    const Words brief{"--duration", "0.5"};
    for (const char* fault : {"loss node=ether end=0.1s", "clash node=ether for=10ms",
                              "loss node=ircom end=0.1s", "swap link=tam0.radio end=0.1s"}) {
        const Ended ended = bench.run("never", with_faults(file, {fault}, brief));
        INFO(fault << "\n" << ended.err);
        CHECK(ended.status == 1);
        CHECK_THAT(ended.err + ended.out, Contains("never fired"));
    }
    CHECK(bench.run("may", with_faults(file, {"loss node=ether end=0.1s may_not_fire=true"}, brief)).status ==
          0);
    const Ended refused = bench.run("bad", with_faults(file, {"loss node=ether from=tam7"}, brief));
    CHECK(refused.status == 2);
    CHECK(std::count(refused.err.begin(), refused.err.end(), '\n') == 1);
    CHECK_THAT(refused.err, Contains("'tam7' is at no end of ether (expected coordinator or tam0)"));
}

TEST_CASE("the TAM hears nothing of lost words, and takes one in which two errors leave the check right") {
    const Workbench bench;
    const auto file = bench.file("air.toml", scenario());
    const auto heard = [&](const std::string& fault) {
        const Ended ended = bench.run("o", with_faults(file, {fault}, {"--duration", "5", "--threads", "1"}));
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        std::set<std::string> words;
        for (const auto& [tam, values] : values_of(bench, "o", "heard"))
            words.insert(values.begin(), values.end());
        words.erase("00");  // nothing yet, or nothing new
        return words;
    };
    CHECK(heard("loss node=ircom to=robot0") == std::set<std::string>{"33"});
    CHECK(heard("loss node=ircom to=tam0").empty());
    CHECK(heard("flip node=ircom to=tam0 bit=9").empty());
    // 0x33 = 00110011: its second and third bit change places.
    CHECK(heard("flip node=ircom to=tam0 bit=1 bits=2") == std::set<std::string>{"53"});
}

TEST_CASE("a campaign sweeps faults of the air as it does those of lines, and prunes what meets no frame") {
    const Workbench bench;
    bench.file("air.toml", scenario());
    const auto file = bench.file("campaign.toml", R"([campaign]
scenario = "air.toml"
duration = "3 s"

[[sweep]]
name = "air"
fault = { node = "ether", from = "tam0", begin = "0.2 s", count = 1 }
over = { kind = ["loss", "corrupt"] }

[[sweep]]
name = "light"
fault = { node = "ircom", begin = "0.3 s", count = 1 }
over = { kind = ["duplicate"], to = ["tam0"] }

[[sweep]]
name = "module"
fault = { link = "tam0.radio", kind = "swap", begin = "20 s" }
)");
    const Ended ended = bench.puckloop({"faults", "campaign", file, "--out", bench.out("c").string()});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const auto rows = bench.csv("c", "results.csv");
    REQUIRE(rows.size() == 4);
    for (const Row& row : rows) {
        CAPTURE(row.at("faults"), row.at("outcome"));
        if (row.at("sweep") == "module") {
            CHECK(row.at("outcome") == "pruned");
            continue;
        }
        CHECK(row.at("outcome") != "not fired");
        CHECK(row.at("fired") == "1");
    }
    // One frame lost on air is sent again, and somebody counts it.
    CHECK(rows[0].at("outcome") == "detected");
    CHECK_THAT(rows[0].at("symptoms"), Contains("mac.retries"));
}
