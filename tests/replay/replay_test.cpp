// Boards of real runs, executed alone: bit for bit, and with changes drawn at random found at their place.

#include "tests/kit/scratch.h"
#include "cosim/trace/trace_csv.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <random>
#include <vector>

#include <sys/wait.h>

using namespace puckloop;
using namespace puckloop::cosim;

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

std::string scenario(const char* name) {
    return fmt::format("{}/scenarios/{}.toml", PUCKLOOP_SOURCE, name);
}

std::string record(const char* name, double duration, const std::string& options = {},
                   const std::string& folder = "record") {
    const std::string out = (tests::scratch_path("puckloop_replay") / folder).string();
    const Called run = call(
        fmt::format("run {} --duration {} --record --out {} {}", scenario(name), duration, out, options));
    INFO(run.out);
    REQUIRE(run.status <= 1);  // 1: a mutant may make a run fail; what it did until then is recorded
    return out;
}

std::vector<std::string> lines_of(const std::string& file) {
    std::ifstream in(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
    REQUIRE(!lines.empty());
    return lines;
}

bool is_from(const std::string& line, const std::string& node) {
    const std::size_t link = line.find(','), from = line.find(',', link + 1);
    return line.compare(from + 1, node.size() + 1, node + ",") == 0;
}

std::string time_of(const std::string& line) {
    return line.substr(0, line.find(','));
}

/// A HEX file with one bit of one data byte inverted, its check sum set right.
bool mutate(const std::string& from, const std::string& to, std::mt19937& random) {
    std::vector<std::string> lines = lines_of(from);
    std::string& line = lines[random() % lines.size()];
    const auto byte = [&](std::size_t n) {
        return static_cast<unsigned>(std::stoul(line.substr(1 + 2 * n, 2), nullptr, 16));
    };
    if (line.size() < 11 || byte(3) != 0 || byte(0) == 0) return false;
    const std::size_t at = 4 + random() % byte(0);
    line.replace(1 + 2 * at, 2, fmt::format("{:02X}", byte(at) ^ (1U << random() % 8)));
    unsigned sum = 0;
    for (std::size_t n = 0; n < 4 + byte(0); ++n)
        sum += byte(n);
    line.replace(1 + 2 * (4 + byte(0)), 2, fmt::format("{:02X}", (0x100 - sum % 0x100) % 0x100));
    std::ofstream out(to);
    for (const std::string& one : lines)
        out << one << '\n';
    return true;
}

}  // namespace

TEST_CASE("boards, buses and worlds of a recorded run replay bit for bit") {
    const std::string pair = record("rab_pair", 0.7);
    for (const char* node : {"leader.pic", "follower.rab", "leader.i2c", "ir", "world"}) {
        const Called called = call(fmt::format("replay {} {} --node {}", scenario("rab_pair"), pair, node));
        INFO(called.out);
        CHECK(called.status == 0);
        CHECK_THAT(called.out, Catch::Contains(" out as recorded, until 0.7") && !Catch::Contains(" 0 out"));
    }
    const std::string tams = record("tam", 1.5, "", "tam");
    for (const char* node : {"tam0.avr", "tam1.xbee", "ether"}) {
        const Called called = call(fmt::format("replay {} {} --node {}", scenario("tam"), tams, node));
        INFO(called.out);
        CHECK(called.status == 0);
        CHECK_THAT(called.out, !Catch::Contains(" 0 out"));
    }
}

TEST_CASE("every node of runs with faults replays bit for bit, Linux programs to their end") {
    const unsigned seed = Catch::rngSeed();
    std::mt19937 random{seed};
    INFO("--rng-seed " << seed);
    const auto share = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random() % 1000) / 1000.0;
    };
    const std::string faults = fmt::format(
        " --seed {} --fault 'drop link=robot0.uart from=robot0.pic probability={:.4f}'"
        " --fault 'flip link=robot0.uart at={:.4f}s may_not_fire=true'"
        " --fault 'break link=robot0.uart from=robot0.linux at={:.4f}s'"
        " --fault 'delay link=robot0.uart from=robot0.linux delay=3ms probability=0.05 may_not_fire=true'"
        " --fault 'nack link=robot0.i2c probability={:.3f} may_not_fire=true'"
        " --fault 'flip node=robot0.pic at={:.4f}s space=ram'"
        " --fault 'clock node=robot0.pic ppm={} begin={:.4f}s'",
        random() % 1000, share(0.002, 0.03), share(0.4, 1.0), share(0.4, 1.0), share(0.01, 0.2),
        share(0.3, 1.0), random() % 6000, share(0.3, 1.0));
    const std::string hello = record("hello", 1.2, faults, "hello");
    for (const char* node : {"robot0.pic", "robot0.linux", "robot0.i2c", "world"}) {
        const Called called =
            call(fmt::format("replay {} {} --node {}{}", scenario("hello"), hello, node, faults));
        INFO(faults << "\n" << called.out);
        CHECK(called.status == 0);
    }
    const std::string tams = record("tam", 2.2, "", "tam_all");
    for (const char* node : {"coordinator.linux", "coordinator.xbee", "ircom", "robot0.pic", "world"}) {
        const Called called = call(fmt::format("replay {} {} --node {}", scenario("tam"), tams, node));
        INFO(called.out);
        CHECK(called.status == 0);
    }
    const std::string swarm = record("swarm", 0.25, "", "swarm");
    const std::string robot = fmt::format("robot{}", random() % 8);
    for (const char* part : {".pic", ".rab", ".i2c"}) {
        const Called called =
            call(fmt::format("replay {} {} --node {}{}", scenario("swarm"), swarm, robot, part));
        INFO(called.out);
        CHECK(called.status == 0);
    }
    const std::string own = record("own_rab", 0.4, "", "own_rab");
    for (const char* node : {"robot0.pic", "robot1.rab"}) {
        const Called called = call(fmt::format("replay {} {} --node {}", scenario("own_rab"), own, node));
        INFO(called.out);
        CHECK(called.status == 0);
    }
}

TEST_CASE("a board replays from a state saved in the middle of the run, and shows its registers from there") {
    const std::string state = (tests::scratch_path("puckloop_replay") / "middle.state").string();
    std::filesystem::create_directories(std::filesystem::path(state).parent_path());
    const std::string out =
        record("rab_pair", 0.8, fmt::format("--save-state {} --at 0.45s", state), "middle");
    for (const char* node : {"leader.pic", "follower.rab"}) {
        const std::string dump = state + ".vcd";
        const Called called = call(fmt::format(
            "replay {} {} --node {} --from-state {} --vcd {} --registers PC --from 0.4 --to 0.4502",
            scenario("rab_pair"), out, node, state, dump));
        INFO(called.out);
        CHECK(called.status == 0);
        CHECK_THAT(called.out, !Catch::Contains(" 0 out"));
        // The first value of the program counter stands at the state's time.
        std::string first;
        for (const std::string& line : lines_of(dump)) {
            if (line.starts_with("#")) first = line;
            if (line.starts_with("b") && !line.starts_with("bx") && first.size() > 1 && line.size() > 12)
                break;
        }
        CHECK(first.substr(1, 3) == "450");
        const Called whole = call(
            fmt::format("replay {} {} --node {} --from-state {}", scenario("rab_pair"), out, node, state));
        INFO(whole.out);
        CHECK(whole.status == 0);
        CHECK_THAT(whole.out, Catch::Contains("until 0.8"));
    }
}

TEST_CASE("a record without the wanted rows is refused, and the trace does not change by recording") {
    const std::string out = record("rab_pair", 0.3);
    const std::vector<std::string> all = lines_of(out + "/record.csv"), some = lines_of(out + "/trace.csv");
    CHECK(all.size() > some.size());
    std::size_t at = 0;  // the trace is the record without some rows
    for (const std::string& line : all)
        if (at < some.size() && some[at] == line) ++at;
    CHECK(at == some.size());
    const auto fails = [&](const std::string& arguments, const std::string& text) {
        const Called called = call("replay " + arguments);
        INFO(called.out);
        CHECK(called.status == 2);
        CHECK_THAT(called.out, Catch::StartsWith("puckloop: ") && Catch::Contains(text));
    };
    fails(scenario("rab_pair") + " " + out + " --node nobody", "one of world");
    const std::string pair = scenario("rab_pair"), tam = scenario("tam");
    fails(tam + " " + out + " --node tam0.avr", fmt::format("is of a run of {}, not of {}", pair, tam));
    fails(pair + " " + out + " --node leader.pic --seed 77",
          "is of a run with seed 1, and this replay has seed 77 (expected --seed 1)");
    // A run that was killed left no report to compare with.
    std::filesystem::remove(out + "/report.json");
    fails(tam + " " + out + " --node tam0.avr", "holds no message of tam0.avr");
    fails(scenario("rab_pair") + " /tmp --node leader.pic", "record.csv");
    std::ofstream(out + "/record.csv", std::ios::app) << "rubbish\n";
    fails(scenario("rab_pair") + " " + out + " --node leader.pic", fmt::format("line {}", all.size() + 1));
}

TEST_CASE("the scenario of a record may be a copy, or have changed in its place") {
    const auto folder = tests::scratch_path("puckloop_replay");
    std::filesystem::create_directories(folder);
    const std::string first = folder / "first.toml", copy = folder / "copy.toml", out = folder / "of_first";
    std::string text;
    for (std::string line : lines_of(scenario("hello"))) {
        if (const auto at = line.find("../firmware"); at != std::string::npos)
            line.replace(at, 2, PUCKLOOP_SOURCE);
        text += line + "\n";
    }
    std::ofstream(first) << text;
    std::ofstream(copy) << text;
    REQUIRE(call(fmt::format("run {} --duration 0.3 --record --out {}", first, out)).status == 0);
    const std::string rest = " " + out + " --node robot0.pic";
    CHECK(call("replay " + copy + rest).status == 0);
    for (const std::string& file : {first, copy})
        std::ofstream(file, std::ios::app) << "# more\n";
    CHECK(call("replay " + first + rest).status == 0);
    CHECK(call("replay " + copy + rest).status == 2);
}

TEST_CASE("a damaged record is refused in one line, or differs, and brings nothing down") {
    const unsigned seed = Catch::rngSeed();
    std::mt19937 random{seed};
    INFO("--rng-seed " << seed);
    const std::string out = record("rab_pair", 0.3, "", "damaged"), file = out + "/record.csv";
    std::string whole;
    for (const std::string& line : lines_of(file))
        whole += line + "\n";
    const char* kNodes[] = {"leader.pic", "follower.rab", "leader.i2c", "ir", "world"};
    for (int round = 0; round < 20; ++round) {
        std::string text = whole;
        for (std::size_t n = 1 + random() % 3; n > 0; --n) {
            const std::size_t at = text.size() / 4 + random() % (text.size() * 3 / 4);
            if (random() % 3 != 0)
                text[at] = "0123456789,.:abcdef\n\"-"[random() % 22];
            else
                text.erase(at, 1 + random() % 200);
        }
        std::ofstream(file, std::ios::binary) << text;
        const char* node = kNodes[random() % 5];
        const Called called = call(fmt::format("replay {} {} --node {}", scenario("rab_pair"), out, node));
        INFO(node << "\n" << called.out);
        CHECK((called.status == 0 || called.status == 1 || called.status == 2));
        if (called.status == 2) {
            CHECK_THAT(called.out, Catch::StartsWith("puckloop: ") || Catch::Contains("\npuckloop: "));
            CHECK(std::count(called.out.begin(), called.out.end(), '\n') <= 2);
        }
    }
}

TEST_CASE("a message changed in the record is named") {
    std::mt19937 random{Catch::rngSeed()};
    INFO("seed " << Catch::rngSeed());
    const std::string out = record("rab_pair", 0.5), file = out + "/record.csv";
    const std::vector<std::string> lines = lines_of(file);
    std::vector<std::size_t> sent;
    for (std::size_t i = 1; i < lines.size(); ++i)
        if (is_from(lines[i], "leader.pic") && lines[i].find(",uart,") != std::string::npos)
            sent.push_back(i);
    REQUIRE(sent.size() > 100);
    for (int round = 0; round < 6; ++round) {
        std::vector<std::string> changed = lines;
        const std::size_t at = sent[random() % sent.size()];
        if (round % 2 == 0) {
            const std::size_t value = changed[at].find(",uart,") + 6;
            changed[at][value] = changed[at][value] == '0' ? '1' : '0';
        } else {
            changed.erase(changed.begin() + static_cast<std::ptrdiff_t>(at));
        }
        {
            std::ofstream write(file);
            for (const std::string& line : changed)
                write << line << '\n';
        }
        const Called called = call(fmt::format("replay {} {} --node leader.pic", scenario("rab_pair"), out));
        INFO(called.out);
        CHECK(called.status == 1);
        CHECK_THAT(called.out, Catch::Contains("first difference at " + time_of(lines[at]) + " s"));
    }
}

TEST_CASE("a changed firmware differs where a whole run with it differs first") {
    std::mt19937 random{Catch::rngSeed()};
    INFO("seed " << Catch::rngSeed());
    const std::string out = record("rab_pair", 0.5);
    const std::vector<std::string> before = lines_of(out + "/record.csv");
    const std::string image = (tests::scratch_path("puckloop_replay") / "mutant.hex").string();
    int found = 0;
    for (const char* node : {"leader.pic", "leader.rab"}) {
        const std::string firmware =
            fmt::format("{}/firmware/{}", PUCKLOOP_SOURCE,
                        node == std::string("leader.pic") ? "epuck/epuck.hex" : "rab/rab.hex");
        for (int tries = 0; tries < 60; ++tries) {
            if (!mutate(firmware, image, random)) continue;
            const Called called = call(fmt::format("replay {} {} --node {} --firmware {}={}",
                                                   scenario("rab_pair"), out, node, node, image));
            INFO(called.out);
            if (called.status == 0) continue;  // a byte that does not matter here
            if (called.status == 2) continue;  // an image that is refused
            REQUIRE(called.status == 1);
            const std::string whole =
                record("rab_pair", 0.5, fmt::format("--firmware {}={}", node, image), "mutant");
            const std::vector<std::string> after = lines_of(whole + "/record.csv");
            std::size_t line = 0;
            while (line < before.size() && line < after.size() && before[line] == after[line])
                ++line;
            REQUIRE(line < before.size());
            const std::string first = line < after.size()
                                          ? std::min(time_of(before[line]), time_of(after[line]))
                                          : time_of(before[line]);
            CHECK_THAT(called.out, Catch::Contains("first difference at " + first + " s"));
            ++found;
            break;
        }
    }
    CHECK(found == 2);
}
