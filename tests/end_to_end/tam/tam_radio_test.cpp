// TAMs with radio modules and a coordinator's module: real firmware ($PUCKLOOP_IMAGES, tam_firmware.elf)
// where it is there, the project's own else. TAM fact sheet, sections 6 and 7.

#include "base/random.h"
#include "tests/end_to_end/kit/api_frame.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>

using namespace puckloop::tests;
using Catch::Contains;
using Bytes = std::vector<int>;

namespace {

/// Frames that `from` sent on `link`: their data, and when the first byte began.
std::vector<std::pair<double, Bytes>> frames_of(const std::vector<Row>& trace, const std::string& link,
                                                const std::string& from) {
    std::vector<std::pair<double, Bytes>> found;
    bool escaped = false;
    for (const Row& row : trace) {
        if (row.at("link") != link || row.at("from") != from) continue;
        int byte = std::stoi(row.at("value"), nullptr, 16);
        if (byte == 0x7E) {
            found.emplace_back(std::stod(row.at("start_s")), Bytes{});
        } else if (byte == 0x7D) {
            escaped = true;
        } else if (!found.empty()) {
            found.back().second.push_back(escaped ? byte ^ 0x20 : byte);
            escaped = false;
        }
    }
    for (auto& [at, data] : found)
        if (data.size() >= 3) data = Bytes(data.begin() + 2, data.end() - 1);
    return found;
}

bool real() {
    return outside("PUCKLOOP_IMAGES", "tam_firmware.elf").has_value();
}

std::string firmware() {
    if (!real()) WARN("without PUCKLOOP_IMAGES: the project's own firmware in place of the real one");
    return real() ? outside("PUCKLOOP_IMAGES", "tam_firmware.elf")->string() : "own";
}

/// Two TAMs and a coordinator's module with a script at its line.
std::filesystem::path scenario(const Workbench& bench, const std::string& script,
                               const std::string& tam_keys = {}, const std::string& more = {}) {
    bench.file("coordinator.txt", script);
    std::string text = "[run]\nduration = \"12 s\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n";
    for (const char* place : {"50 cm", "-50 cm"})
        text += fmt::format("[[tam]]\nposition = [\"{}\", \"0 m\"]\nfirmware = \"{}\"\nadc_noise = 0\n{}",
                            place, firmware(), tam_keys);
    return bench.file("tams.toml", text +
                                       "[coordinator]\nuart = \"script:coordinator.txt\"\n"
                                       "address = \"0013A200408C04A4\"\n" +
                                       more);
}

const Bytes kFirstTam{0x00, 0x13, 0xA2, 0x00, 0x40, 0x00, 0x00, 0x01};

/// SET_LEDS for the first TAM.
std::string set_leds(int red, int green, int blue) {
    Bytes data{0x10, 1};
    data.insert(data.end(), kFirstTam.begin(), kFirstTam.end());
    data.insert(data.end(), {0xFF, 0xFE, 0, 0, 0x0A, red, green, blue});
    return api_frame(data);
}

}  // namespace

TEST_CASE("TAMs find the coordinator over the air, report, and obey, the same in every placement") {
    const Workbench bench;
    const auto file =
        scenario(bench, "4.0 " + api_frame({8, 1, 'N', 'D'}) + "\n10.8 " + set_leds(0x19, 0, 0x0C) +
                            "\n11.2 " + api_frame({8, 1, 'Q', 'Q'}) + "\n");
    REQUIRE(bench.run("one", {file, "--in-process", "--threads", "1"}).status == 0);
    REQUIRE(bench.run("threads", {file, "--in-process", "--threads", "4"}).status == 0);
    REQUIRE(bench.run("many", {file}).status == 0);
    check_same_run(bench, "one", "threads");
    check_same_run(bench, "one", "many");

    const auto trace = bench.csv("one", "trace.csv");
    const auto sent = frames_of(trace, "tam0.xbee", "tam0.avr");
    const auto got = frames_of(trace, "tam0.xbee", "tam0.xbee");
    REQUIRE(sent.size() >= 4);
    REQUIRE(got.size() >= 4);
    CHECK(got[0].second == Bytes{0x8A, 0x00});
    const auto has = [](const auto& frames, double after, const Bytes& data) {
        return std::any_of(frames.begin(), frames.end(),
                           [&](const auto& one) { return one.first > after && one.second == data; });
    };
    CHECK(has(sent, 0, {8, 1, 'D', 'N', 'C', 'O', 'O', 'R', 'D'}));
    CHECK(has(got, 0, {0x88, 1, 'D', 'N', 0x40, 0xFF, 0xFE, 0x00, 0x13, 0xA2, 0x00, 0x40, 0x8C, 0x04, 0xA4}));
    const auto report =
        std::find_if(sent.begin(), sent.end(), [](const auto& one) { return one.second[0] == 0x10; });
    REQUIRE(report != sent.end());
    CHECK(has(got, report->first, {0x8B, 1, 0xFF, 0xFE, 0, 0, 0}));
    // The two firmwares compute the battery's voltage differently.
    const int volts = real() ? 0xD3 : 0x72;
    CHECK(report->second == Bytes{0x10, 1, 0x00, 0x13, 0xA2, 0x00, 0x40, 0x8C, 0x04,  0xA4, 0xFF,
                                  0xFE, 0, 0,    0,    0,    0,    0,    0,    volts, 0x0E, 0x00});
    if (real()) {
        // Section 6, in its order; section 7: the first report after 10 s.
        CHECK(sent[0].second == Bytes{8, 1, 'N', 'T', 0x82});
        CHECK(sent[1].second == Bytes{8, 1, 'I', 'D', 0x01, 0xB5});
        CHECK(sent[2].second == Bytes{8, 1, 'D', 'N', 'C', 'O', 'O', 'R', 'D'});
        for (const char* name : {"NI", "SH", "SL", "CH"})
            CHECK(has(sent, sent[2].first, {8, 1, name[0], name[1]}));
        CHECK(report->first == Approx(10.0).epsilon(0.01));
        // The module is held in reset for 120 ms (section 6).
        std::vector<double> reset;
        for (const Row& row : trace)
            if (row.at("link") == "tam0.pins" && row.at("detail") == "xbee_reset")
                reset.push_back(std::stod(row.at("time_s")));
        REQUIRE(reset.size() == 2);
        CHECK(reset[1] - reset[0] == Approx(0.120).epsilon(0.01));
    }
    // What the coordinator's host hears: answers to ND, reports, and the new colours after SET_LEDS.
    const auto heard = frames_of(trace, "coordinator.uart", "coordinator.xbee");
    const auto count = [&](auto condition) {
        return std::count_if(heard.begin(), heard.end(),
                             [&](const auto& one) { return condition(one.second); });
    };
    const Bytes nd{0x88, 1, 'N', 'D', 0x40, 0xFF, 0xFE, 0x00, 0x13, 0xA2, 0x00, 0x40, 0x00, 0x00, 0x01};
    CHECK(count([&](const Bytes& data) {
              return data.size() > 15 && std::equal(nd.begin(), nd.end(), data.begin());
          }) <= 1);  // within NT (13 s), which is longer than what is left
    CHECK(count([](const Bytes& data) { return data[0] == 0x90 && data.size() == 20 && data[12] == 0; }) >=
          3);
    CHECK(count([volts](const Bytes& data) {
              return data == Bytes{0x90, 0x00, 0x13, 0xA2, 0x00, 0x40, 0x00, 0x00,  0x01, 0xFF,
                                   0xFE, 1,    0x00, 0x19, 0x00, 0x0C, 0x00, volts, 0x0E, 0x00};
          }) == 1);
    CHECK(count([](const Bytes& data) { return data == Bytes{0x88, 1, 'Q', 'Q', 2}; }) == 1);
    const auto nodes = bench.report("one")["nodes"];
    CHECK(nodes["coordinator.xbee"]["at"]["unknown"]["QQ"] == 1);
    CHECK(nodes["ether"]["stations"]["tam0"]["delivered"] >= 2);
    CHECK(bench.report("one")["warnings"].empty());
    // The frames on air read back.
    const Ended counts =
        bench.puckloop({"trace", bench.out("one") / "trace.csv", "--kind", "radio", "--json"});
    CHECK_THAT(counts.out, Contains("tam0.radio") && Contains("radio_frames"));
}

TEST_CASE("a coordinator that sends garbage and floods: counted, nothing hangs, reports still arrive") {
    const Workbench bench;
    puckloop::RandomStream random(1, "garbage");
    std::string script;
    for (int line = 0; line < 80; ++line) {
        script += fmt::format("{:.3f}", 3.0 + 0.05 * line);
        for (int i = 0; i < 60; ++i)
            script += fmt::format(" {:02x}", random.below(4) == 0 ? 0x7E : random.below(256));
        script += "\n";
    }
    // Then packets to nobody without a pause: each is looked for in vain for almost two seconds.
    const Bytes all{0x10, 1, 0, 0x13, 0xA2, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFE, 0, 0, 0x7F, 1, 2, 3};
    for (int line = 0; line < 90; ++line)
        script += fmt::format("{:.3f} {}\n", 8.5 + 0.01 * line, api_frame(all));
    const auto file = scenario(bench, script);
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const auto module = bench.report("o")["nodes"]["coordinator.xbee"];
    CHECK(module["uart"]["bad_frames"].size() >= 2);
    CHECK(module["uart"]["overflow"] > 0);
    CHECK(module["air"]["sent"] > 4);
    const auto heard = frames_of(bench.csv("o", "trace.csv"), "coordinator.uart", "coordinator.xbee");
    CHECK(std::count_if(heard.begin(), heard.end(), [](const auto& one) {
              return one.second[0] == 0x90 && one.second.size() == 20;
          }) >= 2);
}

TEST_CASE("two TAMs with one address: a warning, and both obey") {
    const Workbench bench;
    const auto file =
        scenario(bench, "10.8 " + set_leds(1, 2, 3) + "\n", "[tam.xbee]\naddress = \"0013A20040000001\"\n");
    REQUIRE(bench.run("o", {file, "--in-process"}).status == 0);
    const auto report = bench.report("o");
    REQUIRE(report["warnings"].size() == 1);
    CHECK_THAT(report["warnings"][0].get<std::string>(),
               Contains("ether: tam0 and tam1 have one address, 0013A20040000001"));
    for (const char* module : {"tam0.xbee", "tam1.xbee"})
        CHECK(report["nodes"][module]["air"]["received"] == 1);
}

TEST_CASE("faults on the air: what is lost is tried again, what is flipped is found") {
    const Workbench bench;
    const auto file =
        scenario(bench, "10.8 " + set_leds(1, 2, 3) + "\n", "",
                 "[[fault]]\nlink = \"tam0.radio\"\nfrom = \"ether\"\nkind = \"flip\"\nbegin = \"5 s\"\n"
                 "[[fault]]\nlink = \"tam1.radio\"\nkind = \"disconnect\"\nbegin = \"2 s\"\n");
    REQUIRE(bench.run("o", {file, "--in-process"}).status == 0);
    const auto report = bench.report("o");
    CHECK(report["nodes"]["tam0.xbee"]["air"]["bad_frames"]["check"] >= 1);
    CHECK(report["nodes"]["tam0.xbee"]["air"]["received"] == 0);
    CHECK(report["links"]["tam1.radio"]["from_a"]["lost"] >= 1);
    // The report of the one that is cut off never arrives, and the firmware goes on.
    CHECK(report["nodes"]["coordinator.xbee"]["air"]["received"] >= 1);
}

TEST_CASE(
    "an image that is not the board's, and one that a reset does not find: said, counted, over at once") {
    const Workbench bench;
    // An ELF file of an ATmega328P: machine 83, architecture avr5, one empty section.
    std::string elf(92, '\0');
    const auto put = [&elf](std::size_t at, int value) { elf[at] = static_cast<char>(value); };
    elf.replace(0, 7,
                "\x7f"
                "ELF\x01\x01\x01",
                7);
    for (const auto& [at, value] : std::map<std::size_t, int>{
             {16, 2}, {18, 83}, {20, 1}, {32, 52}, {36, 5}, {40, 52}, {42, 32}, {46, 40}, {48, 1}})
        put(at, value);
    const auto with = [&](const std::string& image) {
        return bench.file("bad.toml",
                          "[run]\nduration = \"0.3 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[[tam]]\n"
                          "position = [\"0 cm\", \"0 cm\"]\nfirmware = \"" +
                              image + "\"\n");
    };
    bench.file("other.elf", elf);
    const Ended other = bench.run("o", {with("other.elf"), "--in-process"});
    INFO(other.err);
    CHECK(other.status == 2);
    CHECK(std::count(other.err.begin(), other.err.end(), '\n') == 1);
    CHECK_THAT(other.err, Contains("other.elf: offset 0x24: is for another AVR, architecture avr5"));
    // Not where fuses send a reset: a warning, as wrong fuses are.
    bench.file("nowhere.hex", ":02100000FFCF20\n:00000001FF\n");
    REQUIRE(bench.run("n", {with("nowhere.hex"), "--in-process"}).status == 0);
    const auto warnings = bench.report("n")["warnings"].dump();
    CHECK_THAT(warnings, Contains("nothing is at 0x00000, where a reset leads with fuse high 0xDF"));
}
