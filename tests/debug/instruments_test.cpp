// What --trace, --watch, --stats, --callgrind and --coverage say of a program whose course is known, and that
// other people's tools read it.

#include "base/json.h"
#include "tests/exec/command.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <sstream>
#include <vector>

using namespace puckloop;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using exec::text_of;
using exec::Workbench;

namespace {

unsigned draw(std::mt19937& random, std::size_t below) {
    return static_cast<unsigned>(random() % below);
}

bool installed(const std::string& tool) {
    return std::system(("command -v " + tool + " >/dev/null").c_str()) == 0;
}

std::string printed(const Workbench& bench, const std::string& command) {
    const std::string out = bench.folder + "/printed";
    INFO(command);
    CHECK(std::system((command + " >" + out + " 2>&1 </dev/null").c_str()) == 0);
    return text_of(out);
}

/// Rows of a trace: its columns.
std::vector<std::vector<std::string>> rows(const std::string& file) {
    std::vector<std::vector<std::string>> found;
    std::istringstream lines(text_of(file));
    for (std::string line; std::getline(lines, line);) {
        std::vector<std::string> columns(1);
        for (const char c : line)
            c == '\t' ? columns.emplace_back() : columns.back() += c;
        found.push_back(columns);
    }
    return found;
}

/// Calls a function `times` times, each of which reads a byte that nothing wrote.
std::string counting_image(const Workbench& bench, unsigned times, unsigned value) {
    const std::string source = fmt::format(R"(
        goto    main
        .org    0x100
main:   mov     #0x0900, w15
        mov     #0x27f0, w0
        mov     w0, SPLIM
        mov     #{}, w5
again:  rcall   work
        dec     w5, w5
        bra     nz, again
stop:   bra     stop
work:   mov     0x0B00, w1
        mov     #0x{:x}, w2
        push    w2
        repeat  #9
        nop
        pop     w3
        mov     w3, 0x0C00
        return
)",
                                           times, value);
    return bench.image("count.hex", exec::assembled(source));
}

}  // namespace

TEST_CASE("traces, watches and statistics of a dsPIC without symbols") {
    const Workbench bench;
    std::mt19937 random(Catch::rngSeed() + 5);
    const unsigned times = 3 + draw(random, 20), value = draw(random, 0x10000);
    const std::string image = counting_image(bench, times, value);
    const std::string what = "--mcu dspic30f6014a " + image + " ";
    const std::string trace = bench.folder + "/trace.tsv", grind = bench.folder + "/callgrind.out";
    const std::string stop = "0x10e";
    const auto plain = bench.run(what + "--stop-at " + stop + " --json");
    const auto run =
        bench.run(what + "--stop-at " + stop + " --json --stats --trace " + trace + " --callgrind " + grind);
    REQUIRE(plain.status == 0);
    REQUIRE(run.status == 0);
    const auto before = nlohmann::json::parse(plain.out), after = nlohmann::json::parse(run.out);
    CHECK(after.at("cycles") == before.at("cycles"));
    CHECK(after.at("instructions") == before.at("instructions"));

    // Each instruction once, in order, and what it did.
    const auto lines = rows(trace);
    CHECK(lines.front() ==
          std::vector<std::string>{"cycle", "pc", "place", "line", "instruction", "changes"});
    CHECK(lines.size() - 1 == before.at("instructions").get<std::size_t>());
    std::map<std::string, int> changes;
    for (const auto& line : lines)
        if (line.size() == 6) ++changes[line[5]];
    CHECK(changes[fmt::format("w2=0x{:04x}", value)] == 1);
    CHECK(changes[fmt::format("[0x0c00]=0x{:04x}", value)] == static_cast<int>(times));
    CHECK(std::count_if(lines.begin(), lines.end(), [](const auto& line) {
              return line.size() == 6 && line[5].starts_with("w5=0x0000");
          }) == 1);

    // The function's cost: 8 instructions and the ten iterations of one, less the repeated one itself.
    const auto& stats = after.at("stats");
    std::uint64_t cycles = 0;
    nlohmann::json work;
    for (const auto& function : stats.at("functions")) {
        cycles += function.at("cycles").get<std::uint64_t>();
        if (function.at("address") == "0x000110") work = function;
    }
    CHECK(cycles == before.at("cycles"));
    REQUIRE(work.is_object());
    CHECK(work.at("instructions") == times * 17);
    CHECK(work.at("cycles") == times * 19);     // the return takes 3
    CHECK(stats.at("stack").at("bytes") == 6);  // a return address and a word
    CHECK(stats.at("unwritten_reads") == 2 * times);
    CHECK(stats.at("unwritten").at(0).at("address") == 0x0B00);
    CHECK(stats.at("unwritten").at(0).at("times") == times);

    // Inclusive cost of the calls: what the function cost.
    CHECK_THAT(text_of(grind),
               Contains(fmt::format("calls={} 0x110 0\n0x108 0 {} {}\n", times, times * 19, times * 17)));
    if (installed("callgrind_annotate")) {
        const std::string shown =
            printed(bench, "callgrind_annotate --threshold=100 --inclusive=yes " + grind);
        CHECK_THAT(shown, Contains("PROGRAM TOTALS") && Contains("0x000110"));
    } else {
        WARN("skipped: callgrind_annotate (package valgrind) is not installed");
    }

    // A stretch and a window of time.
    CHECK(bench.run(what + "--cycles 5000 --trace " + trace + " --trace-range 0x110..0x11e").status == 0);
    CHECK(rows(trace).size() - 1 == times * 17);
    CHECK(bench.run(what + "--cycles 5000 --trace " + trace + " --trace-from 0.0001 --trace-to 0.0002")
              .status == 0);
    const auto window = rows(trace);
    REQUIRE(window.size() > 10);
    const double hertz = 7372800.0 * 8 / 4;
    CHECK(std::stod(window.at(1).at(0)) >= 0.0001 * hertz);
    CHECK(std::stod(window.back().at(0)) <= 0.0002 * hertz);

    // Watches.
    const auto written = bench.run(what + "--seconds 1 --watch 0x0C00:2");
    CHECK(written.status == 0);
    CHECK_THAT(written.out, StartsWith("stopped: watch 0x0C00:2: write of 0x0c00 by 0x00011c"));
    CHECK_THAT(bench.run(what + "--seconds 1 --watch SPLIM").out,
               Contains("watch SPLIM: write of 0x0020 by 0x000104"));
    CHECK_THAT(bench.run(what + "--seconds 1 --watch 0x0B01/r").out, Contains("read of 0x0b00 by 0x000110"));
    CHECK(bench.run(what + "--seconds 0.01 --watch 0x0B00").status == 1);  // nobody writes there
    for (const char* wrong : {"0x10000", "frob", "0x0C00:0", "0x0C00/x"}) {
        const auto refused = bench.run(what + "--watch " + wrong);
        CHECK(refused.status == 2);
        CHECK(exec::one_line(refused.err));
    }
    for (const char* wrong : {"--trace "
                              "x --trace-range 5..4",
                              "--coverage x", "--stats --gdb :0"}) {
        const auto refused = bench.run(what + wrong);
        CHECK(refused.status == 2);
        CHECK(exec::one_line(refused.err));
    }
    for (const char* output : {"--trace", "--callgrind"}) {
        const auto nowhere = bench.run(fmt::format("{}--cycles 100 {} /nowhere/file", what, output));
        CHECK(nowhere.status == 2);
        CHECK_THAT(nowhere.err,
                   Catch::Contains("/nowhere/file: cannot be written: No such file or directory"));
    }
    // A disk that is full leaves nothing. Here a limit stands in for its end.
    rlimit limit{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &limit) == 0);
    const rlimit little{1 << 20, limit.rlim_max};  // room for the memory of the chip
    std::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &little) == 0);
    const std::string part = bench.folder + "/part.tsv";
    const auto full = bench.run(what + "--cycles 100000 --trace " + part);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &limit) == 0);
    CHECK(full.status == 1);
    CHECK(exec::one_line(full.err));
    CHECK_THAT(full.err, Contains("part.tsv: cannot be written"));
    CHECK_FALSE(std::filesystem::exists(part));
}

TEST_CASE("profile and coverage of a C program with interrupts") {
    const std::string lamp = PUCKLOOP_LAMP;
    if (lamp.empty()) {
        WARN("skipped: avr-gcc with avr-libc is not installed");
        return;
    }
    const Workbench bench;
    const std::string info = bench.folder + "/lamp.info", grind = bench.folder + "/callgrind.out";
    const std::string sources = std::string(PUCKLOOP_SOURCE) + "/tests/debug/programs";
    const std::string what = "--mcu atmega1284p " + lamp + " --seconds 0.01005 --json --log " + bench.folder;
    const auto plain = bench.run(what + "/plain");
    const auto run = bench.run(what + "/stats --stats --callgrind " + grind + " --coverage " + info +
                               " --sources " + sources);
    REQUIRE(run.status == 0);
    CHECK(text_of(bench.folder + "/stats/pins.csv") == text_of(bench.folder + "/plain/pins.csv"));
    const auto before = nlohmann::json::parse(plain.out), after = nlohmann::json::parse(run.out);
    CHECK(after.at("cycles") == before.at("cycles"));
    CHECK(after.at("instructions") == before.at("instructions"));

    // A tick each 1600 clocks: 100 of them, each with one call of both functions.
    constexpr int kTicks = 100;
    const std::string calls = text_of(grind);
    CHECK_THAT(calls, Contains("fn=__vector_13") && Contains("cfn=brightness\ncalls=100 ") &&
                          Contains("cfn=remember\ncalls=100 ") && !Contains("cfn=never"));
    const auto& reads = after.at("stats").at("unwritten");
    REQUIRE(reads.size() == 1);  // boots, in .noinit
    CHECK(reads.at(0).at("times") == 1);
    CHECK_THAT(reads.at(0).at("line").get<std::string>(), StartsWith("lamp.c:"));
    // main's return address, and what the interrupt saves below a call.
    CHECK(after.at("stats").at("stack").at("bytes") >= 4);

    // Lines, as the source has them.
    std::map<std::string, int> source;
    std::istringstream lines(text_of(sources + "/lamp.c"));
    int number = 0;
    for (std::string line; std::getline(lines, line);)
        source[line] = ++number;
    const std::string covered = text_of(info);
    const auto line_of = [&](const char* text) { return source.at(text); };
    CHECK_THAT(covered, Contains("SF:" + sources + "/lamp.c\n"));
    CHECK_THAT(covered, Contains(fmt::format("DA:{},{}\n", line_of("    ticks++;"), kTicks)));
    CHECK_THAT(covered, Contains(fmt::format("DA:{},{}\n", line_of("        PORTB ^= 1;"), kTicks)));
    CHECK_THAT(covered, Contains(fmt::format("DA:{},1\n", line_of("    DDRB = 1;"))));
    CHECK_THAT(covered, Contains(fmt::format("DA:{},0\n", line_of("    PORTB = 0;"))));
    CHECK_THAT(covered, Contains(fmt::format("FNDA:{},remember\n", kTicks)) && Contains("FNDA:0,never\n"));

    if (installed("callgrind_annotate")) {
        const std::string shown =
            printed(bench, "callgrind_annotate --auto=yes --include=" + sources + " " + grind);
        CHECK_THAT(shown, Contains("lamp.c:main") && Contains("PORTB ^= 1;"));
    } else {
        WARN("skipped: callgrind_annotate (package valgrind) is not installed");
    }
    if (installed("genhtml")) {
        CHECK_THAT(printed(bench, "genhtml -q --output-directory " + bench.folder + "/html " + info +
                                      " && ls " + bench.folder + "/html"),
                   Contains("index.html"));
        CHECK_THAT(printed(bench, "lcov --summary " + info), Contains("lines") && Contains("functions"));
    } else {
        WARN("skipped: genhtml (package lcov) is not installed");
    }
}
