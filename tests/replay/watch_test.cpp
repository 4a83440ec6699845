// Registers and variables in a replay's dump: programs with values and delays drawn at random say when what
// must change, to the cycle.

#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <vector>

#include <sys/wait.h>

namespace {

struct Called {
    int status = -1;
    std::string out;
};

Called call(const std::string& arguments) {
    std::FILE* pipe = popen(fmt::format("{} {} 2>&1", PUCKLOOP_PROGRAM, arguments).c_str(), "r");
    REQUIRE(pipe != nullptr);
    Called called;
    std::array<char, 4096> buffer{};
    while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe))
        called.out.append(buffer.data(), got);
    called.status = WEXITSTATUS(pclose(pipe));
    return called;
}

std::string scratch(const std::string& name) {
    const auto folder = puckloop::tests::scratch_path("puckloop_watch");
    std::filesystem::create_directories(folder);
    return (folder / name).string();
}

void write(const std::string& file, const std::string& text) {
    std::ofstream(file) << text;
}

/// That of --rng-seed, or another each time.
unsigned drawn_seed() {
    return Catch::rngSeed();
}

using Changes = std::vector<std::pair<long long, unsigned long long>>;

/// Known values of a dump's variables, by name.
std::map<std::string, Changes> dump_of(const std::string& file) {
    std::ifstream in(file);
    std::map<std::string, std::string> names;
    std::map<std::string, Changes> dump;
    long long now = 0;
    bool begun = false;
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string first, type, bits, id, name;
        words >> first;
        if (first == "$var") {
            words >> type >> bits >> id >> name;
            names[id] = name;
        }
        begun = begun || first == "$enddefinitions";
        if (first[0] == '#' && first.size() > 1) now = std::stoll(first.substr(1));
        if (!begun || first[0] != 'b' || first == "bx" || !(words >> id)) continue;
        dump[names.at(id)].emplace_back(now, std::stoull(first.substr(1), nullptr, 2));
    }
    return dump;
}

/// The recorded run of one robot, r, whose main board executes `source`: its folder, beside watch.toml.
std::string recorded(const std::string& source) {
    write(scratch("watch.s"), source);
    const Called assembled = call(fmt::format("asm {} -o {}", scratch("watch.s"), scratch("watch.hex")));
    INFO(assembled.out);
    REQUIRE(assembled.status == 0);
    write(scratch("watch.toml"),
          "[run]\nduration = \"20 ms\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[[robot]]\n"
          "name = \"r\"\nposition = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"watch.hex\"\n");
    const std::string out = scratch("out");
    const Called run = call(fmt::format("run {} --record --no-cache --out {}", scratch("watch.toml"), out));
    INFO(run.out);
    REQUIRE(run.status == 0);
    return out;
}

}  // namespace

TEST_CASE("a dsPIC's registers and RAM change in the dump where its program changes them, to the cycle") {
    const unsigned seed = drawn_seed();
    std::mt19937 random{seed};
    INFO("--rng-seed " << seed);
    // Each round: mov #v, W0; mov W0, LATB; mov W0, 0x0850; repeat #n; nop (n + 1 times).
    std::string source = ".org 0\ngoto main\n.org 0x100\nmain: clr TRISB\n";
    std::vector<unsigned> values, delays;
    for (int i = 0; i < 40; ++i) {
        values.push_back(static_cast<unsigned>(1 + random() % 0xFFFF));
        if (i > 0 && values[values.size() - 2] == values.back()) values.back() ^= 1;
        delays.push_back(static_cast<unsigned>(random() % 300));
        source += fmt::format("mov #{}, W0\nmov W0, LATB\nmov W0, 0x0850\nrepeat #{}\nnop\n", values.back(),
                              delays.back());
    }
    source += "forever: bra forever\n";
    const std::string out = recorded(source);
    const Called replay =
        call(fmt::format("replay {} {} --node r.pic --vcd {} --registers LATB,W0 --registers 0x0850,PC",
                         scratch("watch.toml"), out, scratch("watch.vcd")));
    INFO(replay.out);
    REQUIRE(replay.status == 0);
    auto dump = dump_of(scratch("watch.vcd"));
    // What comes before the program's first value is the power-up's.
    for (const char* name : {"LATB", "W0", "0x0850"}) {
        INFO(name);
        Changes& changes = dump[name];
        REQUIRE(changes.size() >= values.size());
        changes.erase(changes.begin(), changes.end() - static_cast<std::ptrdiff_t>(values.size()));
        for (std::size_t i = 0; i < values.size(); ++i)
            CHECK(changes[i].second == values[i]);
    }
    constexpr double kCycle = 1e12 / 14'745'600.0;  // ps: 7.3728 MHz, PLL x8, four clocks each
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
        const auto cycles = [&](const char* name) {
            return static_cast<double>(dump[name][i + 1].first - dump[name][i].first) / kCycle;
        };
        CHECK(cycles("LATB") == Approx(delays[i] + 5).margin(0.01));
        CHECK(cycles("W0") == Approx(delays[i] + 5).margin(0.01));
        // The value is in W0 first, one cycle later at the latch, another in RAM.
        CHECK(static_cast<double>(dump["LATB"][i].first - dump["W0"][i].first) / kCycle ==
              Approx(1).margin(0.01));
        CHECK(static_cast<double>(dump["0x0850"][i].first - dump["W0"][i].first) / kCycle ==
              Approx(2).margin(0.01));
    }
    CHECK(dump["PC"].size() > 4 * values.size());
    // From the middle on, the same.
    const long long middle = dump["LATB"][values.size() / 2].first;
    const Called part = call(fmt::format("replay {} {} --node r.pic --vcd {} --registers LATB --from {:.12f}",
                                         scratch("watch.toml"), out, scratch("part.vcd"),
                                         static_cast<double>(middle) * 1e-12));
    INFO(part.out);
    REQUIRE(part.status == 0);
    const Changes rest = dump_of(scratch("part.vcd"))["LATB"];
    REQUIRE(rest.size() >= 2);
    CHECK(rest[1] == dump["LATB"][values.size() / 2 + (rest[0].second == values[values.size() / 2] ? 1 : 0)]);
}

TEST_CASE("an AVR's timer counts in the dump, its pairs of registers are one value, and RAM follows") {
    const unsigned seed = drawn_seed();
    std::mt19937 random{seed};
    INFO("--rng-seed " << seed);
    // Timer 1 counts every cycle; each round: ldi, sts 0x0300 (2 cycles), a loop of 3 n - 1 after its ldi.
    // A byte on USART 1 at the beginning and the end is what the record has of the board.
    const std::string send = "ldi r18, 8\nsts 0xC9, r18\nldi r18, 85\nsts 0xCE, r18\n";
    std::string source = send + "ldi r16, 1\nsts 0x81, r16\n";
    std::vector<unsigned> values, turns;
    for (int i = 0; i < 30; ++i) {
        values.push_back(static_cast<unsigned>(1 + random() % 255));
        if (i > 0 && values[values.size() - 2] == values.back()) values.back() ^= 1;
        turns.push_back(static_cast<unsigned>(1 + random() % 80));
        source += fmt::format("ldi r16, {}\nsts 0x300, r16\nldi r17, {}\nwait{}: dec r17\nbrne wait{}\n",
                              values.back(), turns.back(), i, i);
    }
    source += send + "forever: rjmp forever\n";
    write(scratch("avr.s"), source);
    REQUIRE(
        call(fmt::format("asm --mcu atmega1284p {} -o {}", scratch("avr.s"), scratch("avr.hex"))).status ==
        0);
    write(scratch("avr.toml"),
          "[run]\nduration = \"20 ms\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[[tam]]\n"
          "name = \"t\"\nposition = [\"0 m\", \"0 m\"]\nstart = \"1 ms\"\nfirmware = \"avr.hex\"\n");
    const std::string out = scratch("avr");
    const Called run = call(fmt::format("run {} --record --no-cache --out {}", scratch("avr.toml"), out));
    INFO(run.out);
    REQUIRE(run.status == 0);
    const Called replay = call(fmt::format("replay {} {} --node t.avr --vcd {} --registers TCNT1,R16,0x300:1",
                                           scratch("avr.toml"), out, scratch("avr.vcd")));
    INFO(replay.out);
    REQUIRE(replay.status == 0);
    auto dump = dump_of(scratch("avr.vcd"));
    constexpr double kCycle = 1e12 / 16e6;
    const Changes& count = dump["TCNT1"];
    REQUIRE(count.size() > 1000);
    for (std::size_t i = 2; i < 1000; ++i) {
        CHECK(count[i].second == count[i - 1].second + 1);
        CHECK(static_cast<double>(count[i].first - count[i - 1].first) / kCycle == Approx(1).margin(0.01));
    }
    Changes& ram = dump["0x300:1"];
    REQUIRE(ram.size() >= values.size());
    ram.erase(ram.begin(), ram.end() - static_cast<std::ptrdiff_t>(values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) {
        CHECK(ram[i].second == values[i]);
        if (i == 0) continue;
        CHECK(static_cast<double>(ram[i].first - ram[i - 1].first) / kCycle ==
              Approx(4 + 3 * turns[i - 1] - 1).margin(0.01));
    }
}

TEST_CASE("what cannot be watched is refused in one line") {
    const std::string out = recorded(".org 0\nforever: bra forever\n");
    const auto fails = [&](const std::string& options, const std::string& text) {
        const Called called =
            call(fmt::format("replay {} {} --node r.pic {}", scratch("watch.toml"), out, options));
        INFO(options << "\n" << called.out);
        CHECK(called.status == 2);
        CHECK(std::count(called.out.begin(), called.out.end(), '\n') == 1);
        CHECK_THAT(called.out, Catch::StartsWith("puckloop: ") && Catch::Contains(text));
    };
    const std::string vcd = "--vcd " + scratch("never.vcd");
    fails("--registers LATB", "no --vcd");
    fails(vcd + " --registers LATBB", "'LATB', or another");
    fails(vcd + " --registers no_such_variable", "the firmware's file has no symbols");
    fails(vcd + " --registers 0x0850:9", "no number of bytes");
    fails(vcd + " --registers 0x0010:1", "there is no RAM at 0x0010");
    fails("--from 0.01", "without --vcd");
    fails(vcd + " --from 0.01 --to 0.005", "not after --from");
    fails("--vcd " + out + "/record.csv", "is the record itself");
    CHECK_FALSE(std::filesystem::exists(scratch("never.vcd")));
}
