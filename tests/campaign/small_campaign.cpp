#include "tests/campaign/small_campaign.h"

#include <catch2/catch.hpp>

#include <cstdlib>

namespace puckloop::tests {

std::filesystem::path small_campaign(const Workbench& bench) {
    bench.hello();
    ::setenv(kImages, PUCKLOOP_SOURCE "/firmware/epuck", 1);
    return bench.file("small.toml", R"([campaign]
scenario = "hello.toml"
firmware = ["robot0.pic=$PUCKLOOP_TEST_IMAGES/epuck.hex"]
duration = "2.6 s"
pairs = 3

[limits]
silence = "400 ms"

[[metric]]
name = "path"
robot = "robot0"
tolerance = "40 %"

[[sweep]]
name = "sensor record"
fault = { link = "robot0.uart", from = "robot0.pic", count = 1 }
over = { kind = ["drop", "flip"] }
after = "1.3 s"
byte = [0, 9, 500]

[[sweep]]
name = "command"
fault = { link = "robot0.uart", from = "robot0.linux", kind = "drop" }
over = { count = [1, 6] }
times = { from = "1.4 s", to = "1.6 s", step = "200 ms" }

[[sweep]]
name = "cable"
fault = { link = "robot0.uart", kind = "disconnect", begin = "1.5 s" }
over = { end = ["1.6 s", "9 s"] }
)");
}

Words campaign_words(const Workbench& bench, const std::filesystem::path& file, const std::string& out,
                     const Words& more) {
    Words words{"faults", "campaign", file.string(), "--out", bench.out(out).string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

std::string table_of(const Workbench& bench, const std::string& out) {
    return text_of(bench.out(out) / "results.csv");
}

std::string reference_table(const Workbench& bench, const std::filesystem::path& file) {
    const Ended ended = bench.puckloop(campaign_words(bench, file, "reference", {"--jobs", "1"}));
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    return table_of(bench, "reference");
}

}  // namespace puckloop::tests
