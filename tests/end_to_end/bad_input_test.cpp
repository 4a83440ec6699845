// Files and options that no run can be made of: status 2, one line that states which and why, nothing
// touched.

#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop::tests;

namespace {

/// Runs hello.toml with these words more; an earlier run's results must stay.
void refused(const Workbench& bench, Words words, const Words& expected, bool with_scenario = true) {
    std::filesystem::create_directories(bench.out("o"));
    const std::string kept = bench.file("o/trajectory.csv", "of an earlier run\n");
    if (with_scenario) words.insert(words.begin(), bench.hello());
    check_one_line(bench.run("o", words), 2, expected, 10.0);
    CHECK(text_of(kept) == "of an earlier run\n");
}

// Start of a program for an ATmega, as avr-gcc makes it.
constexpr const char* kAvrImage = ":100000000C9434000C943E000C943E000C943E0082\n"
                                  ":1000100011241FBECFEFD8E0DEBFCDBF11E0A0E0BE\n"
                                  ":00000001FF\n";

}  // namespace

TEST_CASE("firmware that cannot be used is refused with its file and place") {
    const Workbench bench;
    const std::string good = text_of(PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex");
    std::string bad = good;
    bad[good.find('\n') - 3] = bad[good.find('\n') - 3] == '0' ? '1' : '0';
    refused(bench, {"--firmware", "robot0.pic=nowhere.hex"}, {"nowhere.hex", "no such file"});
    refused(bench, {"--firmware", "robot0.pic=" + bench.folder().string()}, {"is a directory"});
    refused(bench, {"--firmware", "pic=" + bench.file("bad.hex", bad).string()},
            {"bad.hex", "line 1", "checksum"});
    refused(bench, {"--firmware", "pic=" + bench.file("empty.hex", "").string()}, {"empty.hex"});
    refused(bench, {"--firmware", "pic=" + bench.file("avr.hex", kAvrImage).string()},
            {"avr.hex", "another chip"});
    refused(bench, {"--firmware", "robot7.pic=x.hex"}, {"robot7.pic", "robot0.pic"});
    refused(bench, {"--firmware", "x.hex"}, {"'x.hex' is not an assignment", "BOARD=IMAGE"});
    refused(bench, {"--firmware", "tam="}, {"'tam=' names no image file", "BOARD=IMAGE"});
    refused(bench, {"--firmware", "=x.hex"}, {"'=x.hex' names no board", "BOARD=IMAGE"});
}

TEST_CASE("of a long word of the command line a part is shown") {
    const Workbench bench;
    const std::string word = "begin" + std::string(100'000, 'x') + "end";
    constexpr std::size_t kReadable = 700;
    for (const Words& words : {
             Words{word},
             Words{"--" + word},
             Words{"run", "--" + word},
             Words{"run", "--" + word + "=1"},
             Words{"run", "--duration", word},
             Words{"run", "--seed", word},
             Words{"bench", "--case", word},
             Words{"exec", "--board", word},
             Words{"exec", "--seconds", word},
             Words{"gap", "--seed", word},
             Words{"gap", "--" + word},
         }) {
        Words all{PUCKLOOP_PROGRAM};
        all.insert(all.end(), words.begin(), words.end());
        const Ended ended = Process(all, bench.folder()).wait();
        INFO(words.front() << " " << words.back().substr(0, 10));
        check_one_line(ended, 2, {"bytes left out"});
        CHECK(ended.err.size() < kReadable);
    }
}

TEST_CASE("a real image of the range-and-bearing board is none for the e-puck") {
    const auto image = outside("PUCKLOOP_IMAGES", "randb.hex");
    if (!image) {
        WARN("PUCKLOOP_IMAGES has no randb.hex: skipped");
        return;
    }
    const Workbench bench;
    refused(bench, {"--firmware", "robot0.pic=" + image->string()}, {"randb.hex", "another chip"});
}

TEST_CASE("mistakes in a scenario are reported with line and what was perhaps meant") {
    const Workbench bench;
    const std::string good = text_of(bench.hello());
    // `with` takes the place of what stands from `key` to the end of its line.
    const auto wrong = [&](const std::string& key, const std::string& with, Words expected) {
        std::string text = good;
        const std::size_t at = text.find("\n" + key) + 1;
        text.replace(at, text.find('\n', at) - at, with);
        expected.push_back(
            "line " +
            std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n')));
        refused(bench, {bench.file("wrong.toml", text)}, expected, false);
    };
    wrong("heading = ", "headng = \"20 deg\"", {"wrong.toml", "'headng'", "'heading'"});
    wrong("duration = ", "duration = \"60 cm\"", {"is a length", "a time"});
    wrong("duration = ", "duration = 60", {"has no unit"});
    wrong("firmware = ", "firmwar = \"x.hex\"", {"'firmwar'", "'firmware'"});
    wrong("[arena]", "[arena", {"wrong.toml"});
    refused(bench, {"nowhere.toml"}, {"nowhere.toml", "cannot be opened"}, false);
    refused(bench, {bench.folder()}, {"is a directory"}, false);
    refused(bench, {bench.file("text.toml", "this is no TOML\n")}, {"text.toml", "line 1"}, false);
    refused(bench, {}, {"no scenario"}, false);
}

TEST_CASE("a fault on a link that is not there is refused") {
    const Workbench bench;
    const std::string link = bench.hello("\n[[fault]]\nlink = \"robot0.uarrt\"\n");
    check_one_line(bench.run("o", {link}), 2, {"line ", "robot0.uarrt", "expected robot0.uart"});
    const std::string end = bench.hello("\n[[fault]]\nlink = \"robot0.uart\"\nfrom = \"pic\"\n");
    check_one_line(bench.run("o", {end}), 2, {"line ", "'pic'", "robot0.pic"});
}

TEST_CASE("options that make no sense are refused in one line") {
    const Workbench bench;
    refused(bench, {"--durration", "4"}, {"--durration", "perhaps --duration"});
    for (const char* duration : {"abc", "-3", "0", "3 cm", "nan"})
        refused(bench, {"--duration", duration}, {"--duration", duration, "is not a time from"});
    refused(bench, {"--seed", "x"}, {"--seed"});
    refused(bench, {"--threads", "2"}, {"--threads", "--in-process"});
    refused(bench, {"--model", "nowhere.toml"}, {"nowhere.toml"});
    refused(bench, {"another.toml"}, {"another.toml"});
    check_one_line(bench.puckloop({"run", bench.hello(), "--out", ""}), 2, {"--out", "is empty"});
    for (const char* option : {"--model", "--events"})
        refused(bench, {option, ""}, {option, "is empty"});
    refused(bench, {"--paced", "--realtime"}, {"--realtime excludes --paced"});
    refused(bench, {"--fault", "foo"},
            {"--fault \"foo\": ",
             "'link' is missing (expected one of robot0.uart, robot0.i2c; or a node, one of ", "robot0.pic"});
    refused(bench, {"--fault", "drop lnk=robot0.uart"}, {"'lnk'", "perhaps 'link'"});
    check_one_line(bench.puckloop({"bench", "rab", "--pairs", "0"}), 2,
                   {"bench rab: --pairs", "see puckloop bench rab --help"});
    check_one_line(bench.puckloop({"trace", "rab", "nowhere", "--from", "5", "--to", "2"}), 2,
                   {"--to", "2 s is not after --from"});
    check_one_line(bench.puckloop({"runn"}), 2, {"'runn'", "perhaps run"});
    check_one_line(bench.puckloop({}), 2, {"no command"});
}

TEST_CASE("an output folder that cannot be is refused") {
    const Workbench bench;
    const std::string file = bench.file("plain", "keep me\n");
    const Words words{bench.hello(), "--duration", "1"};
    check_one_line(bench.run("plain", words), 2, {"plain", "folder"});
    CHECK(text_of(file) == "keep me\n");
    check_one_line(bench.puckloop({"run", words[0], "--out", "/proc/nowhere"}), 2, {"/proc/nowhere"});
}
