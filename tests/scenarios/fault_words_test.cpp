// [[fault]] tables and faults in one line: the same reader, and nothing that it chokes on.

#include "base/error.h"
#include "base/random.h"
#include "scenarios/reader/faults/event_file.h"
#include "scenarios/reader/faults/fault_places.h"
#include "scenarios/reader/faults/fault_tables.h"
#include "scenarios/reader/faults/fault_words.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <fstream>

using namespace puckloop;
using namespace puckloop::scenarios;
using cosim::FaultSpec;

namespace {

/// A scenario with a serial link and a radio link, without files.
Scenario with_links() {
    Scenario scenario;
    scenario.robots.emplace_back().name = "robot0";
    scenario.robots[0].linux_board.emplace();
    scenario.robots[0].rab.emplace();
    scenario.tams.emplace_back().name = "tam0";
    scenario.tams[0].xbee.fitted = true;
    scenario.world.ircom = true;
    scenario.network.emplace().access_point = {0, 0};
    scenario.network->wifi.emplace();
    scenario.hosts.emplace_back().name = "host0";
    return scenario;
}

FaultSpec one(const std::string& words) {
    Scenario scenario = with_links();
    add_fault(words, scenario);
    return scenario.faults.at(0);
}

std::string problem(const std::string& words) {
    try {
        one(words);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

FaultSpec from_toml(const std::string& keys) {
    const Scenario scenario = with_links();
    const auto file = tests::scratch_path("fault_words");
    std::ofstream(file) << keys;
    const TomlValue table = read_toml(file);
    std::filesystem::remove(file);
    return read_fault("f.toml", 0, table, scenario);
}

/// A text that the parameter takes: its first choice, any word where it has none.
std::string_view first_choice(const cosim::ParameterInfo& parameter) {
    if (parameter.key == "profile") return "0 s 4.1 V, 10 s 3.6 V";
    if (parameter.key == "data") return "64 2c 0D";
    if (parameter.choices.empty()) return "T1Interrupt";
    return parameter.choices.substr(0, parameter.choices.find('|'));
}

}  // namespace

TEST_CASE("words and a table give the same fault") {
    CHECK(
        one("flip link=robot0.uart from=robot0.pic bits=3 burst=true begin=1.5s end=2.5s p=0.1 r=0.4 1-h=90% "
            "skip=4 every=2 count=9 match=f207 offset=3 bytes=0x00,255 position=7 name=\"a b\" "
            "may_not_fire=true") ==
        from_toml(
            "kind = \"flip\"\nlink = \"robot0.uart\"\nfrom = \"robot0.pic\"\nbits = 3\nburst = true\n"
            "begin = \"1.5 s\"\nend = \"2.5 s\"\np = 0.1\nr = 0.4\n1-h = \"90 %\"\nskip = 4\nevery = 2\n"
            "count = 9\nmatch = \"F2 07\"\noffset = 3\nbytes = [\"0\", \"0xff\"]\nposition = 7\n"
            "name = \"a b\"\nmay_not_fire = true\n"));
    CHECK(one("corrupt link=tam0.radio at=2s") ==
          from_toml("kind = \"flip\"\nlink = \"tam0.radio\"\nbegin = \"2 s\"\ncount = 1\n"));
    // Angles with their unit, or as plain degrees.
    CHECK(one("occlusion link=robot0.ir bearing=\"90 deg\" width=30deg").parameters.number("bearing") ==
          Approx(one("occlusion link=robot0.ir bearing=90 width=30").parameters.number("bearing")));
    CHECK(one("stall link=robot0.uart at=2s for=30ms") ==
          from_toml("kind = \"stall\"\nlink = \"robot0.uart\"\nbegin = \"2 s\"\nend = \"2.03 s\"\n"));
}

TEST_CASE("what a fault cannot be is refused by name") {
    const auto said = [](const std::string& words, const std::string& part) {
        CHECK_THAT(problem(words), Catch::Contains(part));
    };
    said("drop", "'link' is missing");
    said("drop link=robot1.uart", "there is no link 'robot1.uart' that can have a fault (expected "
                                  "robot0.uart, robot0.i2c, robot0.ir, tam0.xbee, tam0.radio; did you mean "
                                  "\"robot0.uart\"?)");
    said("drop node=robot0.pic2", "there is no node");
    said("drop link=robot0.uart node=x", "both a link and a node");
    said("dorp link=robot0.uart", "unknown fault kind 'dorp' for robot0.uart (expected one of drop");
    said("stuck link=tam0.radio", "unknown fault kind 'stuck'");
    said("delay link=tam0.radio delay=1ms jitter=2ms", "jitter is larger than the delay");
    said("drop node=ether from=tam7", "'tam7' is at no end of ether");
    said("loss node=ether to=coordinator", "'coordinator' is at no end of ether (expected tam0");
    said("loss node=ether frame=beacon", "expected one of any, data, acknowledge");
    said("clash node=ether from=tam0", "comes from outside");
    said("access_point_away node=network from=robot0", "away for all");
    said("access_point_away node=network count=2", "holds during its whole window");
    said("address_clash node=network to=robot1",
         "'robot1' is at no end of network (expected robot0 or host0");
    said("address_clash node=network share=2", "share is out of range");
    said("address_clash node=network answers=perhaps", "one of reset, nothing");
    said("connection_reset node=network byte=-1", "byte is out of range");
    said("connection_reset node=network byte=x", "no whole number");
    said("dns_silence node=robot0.linux attempts=0", "attempts is out of range");
    said("dns_silence node=network", "unknown fault kind 'dns_silence'");
    said("clash node=ether load=0", "load is out of range");
    said("clash node=ether every=2", "unknown key 'every'");
    said("loss node=ether match=0", "match is no pattern");
    said("loss node=ircom from=robot1", "'robot1' is at no end of ircom (expected robot0 or tam0");
    said("loss node=ircom from=robot0 to=robot0", "receives nothing of its own");
    said("delay node=ircom", "'delay' is missing");
    said("delay node=ircom delay=1ms", "delay is out of range (expected 0.04 to 10 s)");
    said("flip node=ircom bit=9 bits=2", "no word has so many bits");
    said("stuck node=ircom", "unknown fault kind 'stuck'");
    said("drop link=robot0.uart factor=2", "unknown key 'factor'");
    said("drop link=robot0.uart probabilty=2", "perhaps 'probability'");
    said("drop link=robot0.uart at=1s begin=2s", "both at and begin");
    said("drop link=robot0.uart end=1s for=2s", "both end and for");
    said("drop link=robot0.uart at=-1s", "out of range");
    said("drop link=robot0.uart at=2", "has no unit");
    said("drop link=robot0.uart p=0.1 probability=0.2", "both a burst and a probability");
    said("drop link=robot0.uart r=0.1", "unknown key 'r'");
    said("drop link=robot0.uart every=0", "every is out of range");
    said("drop link=robot0.uart match=f2f", "match is no pattern");
    said("drop link=robot0.uart offset=3", "unknown key 'offset'");
    said("drop link=robot0.uart from=robot0.pick", "at no end of robot0.uart");
    said("truncate link=robot0.uart", "'keep' is missing");
    said("adc_stuck node=robot0.pic value=0.5", "'channel' is missing");
    said("occlusion link=robot0.ir bearing=\"30 cm\"", "bearing");
    said("rate link=robot0.uart", "'factor' is missing");
    said("rate link=robot0.uart factor=100", "factor is out of range");
    said("stall link=robot0.uart", "a stall without an end");
    said("swapped_wires link=robot0.uart from=robot0.pic", "no direction");
    said("break link=robot0.uart period=1ms", "too often");
    said("insert link=robot0.uart value=300", "out of range");
    said("type link=robot0.uart", "'data' is missing");
    for (const char* none : {"6", "64 2", "6 4", "xx", " "})
        said(fmt::format("type link=robot0.uart data=\"{}\"", none), "are no bytes");
    said("type link=robot0.uart data=64 baud=1", "baud is out of range");
    said("type link=robot0.uart data=64 period=1ms", "too often");
    said("insert link=robot0.uart value=0x3g", "not a byte");
    said("parity link=robot0.uart mode=odd", "one of wrong, mark, space");
    said("drop link=robot0.uart name=\"a,b\"", "comma");
    for (const char* held : {"sag node=robot0.pic volts=1V", "clock node=robot0.rab ppm=3",
                             "phase_open node=robot0.pic", "foreign_carrier node=robot0.rab",
                             "ambient_burst link=robot0.ir", "starve node=robot0.linux factor=3"})
        for (const char* more : {" probability=0.5", " count=2"})
            said(std::string(held) + more, "holds during its whole window (expected neither probability");
    said("battery node=robot0.pic", "'profile' is missing");
    said("battery node=robot0.pic profile=\"0 s 4.1 V 3\"", "profile: what is '3' (expected times and volts");
    said("battery node=robot0.pic profile=\"1 s 4 V, 1 s 3 V\"", "times do not rise");
    said("battery node=tam0.avr profile=\"1 s 40 V\"", "a voltage of 40 V");
    said("lost_interrupt node=robot0.pic", "'vector' is missing");
    said("late_interrupt node=robot0.pic vector=T1", "'delay' is missing");
    said("occlusion link=robot0.ir width=400", "width is out of range");
    said("chip_flip link=robot0.ir from=robot0.pic", "at no end of robot0.ir");
    said("chip_jitter link=robot0.ir jitter=2ms", "jitter is out of range");
    said("weak_emitter link=robot0.ir emitter=13 gain=0.5", "emitter is out of range");
    said("drop link=robot0.uart \"", "a quote is open");
    said("drop link=robot0.uart link=x", "given twice");
}

TEST_CASE("faults of a network need what they are about") {
    Scenario scenario = with_links();
    const auto said = [&](const std::string& words) -> std::string {
        try {
            add_fault(words, scenario);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    };
    CHECK(said("access_point_away node=network begin=1s for=2s") == "accepted");
    CHECK(said("dns_silence node=host0.linux timeout=1s") == "accepted");
    scenario.network->access_point.reset();
    CHECK_THAT(said("access_point_away node=network"), Catch::Contains("has no access point"));
    scenario.network.reset();
    CHECK_THAT(said("dns_silence node=robot0.linux"), Catch::Contains("without a network"));
}

TEST_CASE("a file of what was done has events and faults, and gives both again") {
    const std::vector<std::string> words{
        "flip link=robot0.uart from=robot0.pic bits=3 burst=true begin=1.5s p=0.1 r=0.4 1-h=90% "
        "bytes=0x00,255",
        "type link=robot0.uart from=robot0.linux begin=\"0.400260416667 s\" data=642c0d baud=9600.5",
        "drop link=robot0.uart name=\"1e5 \\\" may_not_fire=true"};
    std::string text = "[[event]]\nat = \"1 s\"\nlift = \"robot0\"\n";
    for (const std::string& one : words)
        text += fault_toml(fault_table_of(one));
    const auto file = tests::scratch_path("events_and_faults");
    std::ofstream(file) << text;
    Scenario scenario = with_links();
    scenario.events.events.emplace_back();
    scenario.faults.push_back(one(words[0]));
    apply_event_file(file, scenario);
    CHECK(scenario.events.events.size() == 1);
    CHECK(scenario.events.events.at(0).at == cosim::kSecond);
    REQUIRE(scenario.faults.size() == 4);
    for (std::size_t i = 0; i < words.size(); ++i)
        CHECK(scenario.faults[i + 1] == one(words[i]));
    CHECK(fault_tables_of(file).size() == 3);
    std::ofstream(file) << "[[robot]]\n";
    CHECK_THROWS_AS(apply_event_file(file, scenario), InputError);
    std::filesystem::remove(file);
}

TEST_CASE("every kind of every place takes its own parameters") {
    const Scenario scenario = with_links();
    for (const FaultPlace& place : fault_places(scenario))
        for (const cosim::KindInfo& kind : cosim::all_kinds()) {
            if (kind.place != place.kind) continue;
            std::string words =
                fmt::format("{} {}={}", kind.name, place.is_node ? "node" : "link", place.name);
            if (kind.mark == cosim::FaultKind::Stall) words += " for=1s";
            if (kind.mark == cosim::FaultKind::Baud) words += " offset=2%";
            for (const cosim::ParameterInfo& parameter : kind.parameters) {
                if (!parameter.required) continue;
                if (parameter.unit == cosim::Unit::Text) {
                    words += fmt::format(" {}=\"{}\"", parameter.key, first_choice(parameter));
                    continue;
                }
                words += fmt::format(" {}={:.9f}", parameter.key, parameter.low);
                if (parameter.unit == cosim::Unit::Time) words += "s";
                if (parameter.unit == cosim::Unit::Voltage) words += "V";
                if (parameter.unit == cosim::Unit::Integer || parameter.unit == cosim::Unit::Byte)
                    words.erase(words.find('.', words.rfind('=')));
            }
            INFO(words);
            CHECK(problem(words) == "accepted");
        }
}

TEST_CASE("random words are read or refused in one line") {
    RandomStream random(21, "words");
    const std::vector<std::string> pieces{
        "drop",    "flip",   "link=",  "robot0.uart", "tam0.radio",
        "at=",     "2s",     " ",      " ",           "\"",
        "=",       "count=", "-1",     "1e308",       "probability=",
        "0.5",     "nan",    "bytes=", "0x41,",       "match=",
        "f2",      ",",      "for=",   "9e99s",       "begin=",
        "p=",      "r=",     "1-h=",   "every=",      "18446744073709551616",
        "\n",      "\t",     "name=",  "delay",       "delay=",
        "jitter=", "bits=",  "bit=",   "true"};
    int accepted = 0;
    for (int round = 0; round < 4000; ++round) {
        std::string words = round % 2 ? "drop link=robot0.uart " : "";
        for (std::uint64_t n = random.below(8); n > 0; --n)
            words += pieces[random.below(pieces.size())];
        if (random.below(4) == 0 && !words.empty())
            words[random.below(words.size())] = static_cast<char>(random.next());
        const std::string said = problem(words);
        accepted += said == "accepted";
        if (words.find('\n') == std::string::npos) CHECK(said.find('\n') == std::string::npos);
    }
    CHECK(accepted > 50);
    CHECK(accepted < 3000);
}

TEST_CASE("random profiles are read or refused in one line") {
    RandomStream random(22, "profiles");
    const std::vector<std::string> pieces{"0",   "1.5", "4.1",    "s", "ms",      "min",         "V",
                                          "mV",  ",",   ";",      " ", " ",       "-1",          "nan",
                                          "inf", "1e9", "1e-400", "x", "0 s 4 V", "10 s 3.6 V, "};
    int accepted = 0;
    for (int round = 0; round < 4000; ++round) {
        std::string text = round % 2 ? "0 s 4 V" : "";
        for (std::uint64_t n = random.below(8); n > 0; --n)
            text += pieces[random.below(pieces.size())];
        if (random.below(4) == 0 && !text.empty())
            text[random.below(text.size())] = static_cast<char>(random.next());
        std::erase(text, '"');
        const std::string said = problem("battery node=robot0.pic profile=\"" + text + "\"");
        accepted += said == "accepted";
        if (text.find('\n') == std::string::npos) CHECK(said.find('\n') == std::string::npos);
    }
    CHECK(accepted > 50);
    CHECK(accepted < 2500);
    CHECK(one("battery node=robot0.pic profile=\"0 4.1;500ms 3600 mV, 1 min 3 V\"")
              .parameters.text("profile") == "0 4.1;500ms 3600 mV, 1 min 3 V");
}
