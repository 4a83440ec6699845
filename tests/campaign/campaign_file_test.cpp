// Reading campaign files: what is accepted, what is refused, and nothing but InputError for whatever else.

#include "base/error.h"
#include "base/random.h"
#include "campaigns/engine/campaign_file.h"
#include "campaigns/engine/case_run.h"
#include "campaigns/engine/plan.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>

#include <unistd.h>

using namespace puckloop;
using namespace puckloop::faults;

namespace {

const std::string kGood = R"([campaign]
scenario = "hello.toml"
duration = "3 s"
seeds = [4, 7]
cases = 12
pairs = 5

[limits]
silence = "2 s"
departure = "2 cm"

[[metric]]
name = "path"
robot = "robot0"
tolerance = "10 %"

[[metric]]
name = "steps"
value = "/nodes/robot0.pic/wheel_steps/left"
tolerance = 40

[[metric]]
name = "tasks"
log = "coordinator.linux"
lines = "task done"
tolerance = 0

[[sweep]]
name = "one"
fault = { link = "robot0.uart", from = "robot0.pic", count = 1 }
over = { kind = ["drop", "flip"], probability = [0.5, 1] }
after = "1 s"
record = [0, 2]
byte = "all"

[[sweep]]
fault = { kind = "delay", link = "robot0.uart", delay = "5 ms", bytes = ["0x01"] }
times = { from = "1 s", to = "2 s", step = "250 ms" }
)";

struct File {
    explicit File(const std::string& text) : path(tests::scratch_path("campaign")) {
        std::ofstream(path, std::ios::binary) << text;
    }
    ~File() { std::filesystem::remove(path); }
    std::filesystem::path path;
};

}  // namespace

TEST_CASE("a campaign file is read with all of its keys") {
    const File file(kGood);
    const Campaign campaign = read_campaign(file.path);
    CHECK(campaign.duration == 3.0);
    CHECK(campaign.seeds == std::vector<std::uint64_t>{4, 7});
    CHECK(campaign.cases == 12);
    CHECK(campaign.pairs == 5);
    CHECK(campaign.limits.silence == 2.0);
    CHECK(campaign.limits.departure == Approx(0.02));
    REQUIRE(campaign.metrics.size() == 3);
    CHECK(campaign.metrics[2].log == "coordinator.linux");
    CHECK(campaign.metrics[2].lines == "task done");
    CHECK(campaign.metrics[0].relative);
    CHECK(campaign.metrics[0].tolerance == Approx(0.1));
    CHECK(!campaign.metrics[1].relative);
    CHECK(campaign.metrics[1].tolerance == 40.0);
    REQUIRE(campaign.sweeps.size() == 2);
    CHECK(campaign.sweeps[0].over.size() == 2);
    CHECK(campaign.sweeps[0].positions);
    CHECK(!campaign.sweeps[0].bytes);
    CHECK(campaign.sweeps[0].records == std::vector<int>{0, 2});
    CHECK(campaign.sweeps[1].name == "sweep 2");
    CHECK(campaign.sweeps[1].times == std::vector<std::string>{"1 s", "1.25 s", "1.5 s", "1.75 s", "2 s"});
    CHECK(campaign.sweeps[1].fault["bytes"] == nlohmann::json{"0x01"});
}

TEST_CASE("a fault's table survives the way to a worker and is a [[fault]] table again") {
    const File file(kGood);
    const Campaign campaign = read_campaign(file.path);
    const nlohmann::json fault = campaign.sweeps[1].fault;
    CHECK(to_json(to_toml(fault, 3)) == fault);
    const File copy(as_toml({fault, fault}));
    const TomlValue root = read_toml(copy.path);
    const nlohmann::json read = to_json(root);
    REQUIRE(read["fault"].size() == 2);
    CHECK(read["fault"][1] == fault);
    CHECK(in_one_line({fault}) == "kind=delay link=robot0.uart bytes=[\"0x01\"] delay=5ms");
    Case one{.id = 7,
             .phase = "pair",
             .sweep = "a",
             .place = "byte 3",
             .seed = ~0ull,
             .faults = {fault},
             .of = 2,
             .pruned = "x"};
    const Case back = case_from_json(nlohmann::json::parse(to_json(one).dump()));
    CHECK(to_json(back) == to_json(one));
    CHECK(back.seed == ~0ull);
}

TEST_CASE("the campaigns that ship can be run") {
    ::setenv("PUCKLOOP_ARGOS", "/nowhere", 1);
    ::setenv("PUCKLOOP_IMAGES", PUCKLOOP_SOURCE "/firmware/epuck", 1);
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(PUCKLOOP_SOURCE "/campaigns")) {
        if (entry.path().extension() != ".toml") continue;  // the rooms and notes of the folder
        CAPTURE(entry.path().string());
        Campaign campaign = read_campaign(entry.path());
        campaign.firmware.clear();  // not everybody has the original one
        const auto scenario = scenario_of(campaign);
        const auto folder = std::filesystem::temp_directory_path() / fmt::format("check-{}", ::getpid());
        for (const Sweep& sweep : campaign.sweeps)
            check_sweep(campaign, scenario, sweep, folder);
        ++count;
    }
    CHECK(count >= 3);
}

TEST_CASE("whatever is wrong in a campaign file is an InputError") {
    const std::uint64_t seed = GENERATE(1, 2, 3);
    RandomStream random(seed, "campaign fuzz");
    for (int round = 0; round < 400; ++round) {
        std::string text = kGood;
        const auto changes = 1 + random.below(4);
        for (std::uint64_t i = 0; i < changes; ++i) {
            const std::size_t place = random.below(text.size());
            switch (random.below(4)) {
            case 0:
                text[place] = static_cast<char>(random.below(256));
                break;
            case 1:
                text.erase(place, 1 + random.below(20));
                break;
            case 2:
                text.insert(place, text.substr(random.below(text.size()), random.below(30)));
                break;
            default:
                text.insert(place, fmt::format("{}", static_cast<std::int64_t>(random.next())));
            }
        }
        const File file(text);
        try {
            read_campaign(file.path);
        } catch (const InputError& error) {
            CHECK(std::string(error.what()).find('\n') == std::string::npos);
        }
    }
}
