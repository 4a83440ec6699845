// Faults of a Linux program, as a small program sees them that prints what its calls give.

#include "base/error.h"
#include "base/json.h"
#include "base/random.h"
#include "cosim/faults/kinds/kind_table.h"
#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstring>
#include <set>
#include <sstream>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

namespace {

FaultSpec fault(const std::string& kind) {
    FaultSpec spec;
    spec.node = "linux";
    spec.name = kind;
    spec.kind = kind;
    return spec;
}

linuxboard::LinuxSpec suffering(const std::vector<std::string>& args, std::vector<FaultSpec> faults,
                                std::uint64_t seed = 1) {
    linuxboard::LinuxSpec spec = spec_for("calls", args);
    spec.fifo_trigger = 1;
    for (std::size_t i = 0; i < faults.size(); ++i) {
        const KindInfo* kind = find_kind(faults[i].kind, PlaceKind::Linux);
        REQUIRE(kind != nullptr);
        complete(faults[i], *kind);
        check_fault(faults[i], *kind);
        spec.faults.push_back({faults[i], Trigger(faults[i], fault_stream(faults[i], seed, i))});
    }
    return spec;
}

std::vector<std::string> lines(const Bench& bench) {
    std::vector<std::string> all;
    std::istringstream text(bench.log());
    for (std::string line; std::getline(text, line);)
        all.push_back(line);
    return all;
}

/// "read -1 EIO" of "read -1 EIO at 5.0 ms"; and 5.0.
std::string without_time(const std::string& line) {
    return line.substr(0, line.find(" at "));
}
double time_of(const std::string& line) {
    return std::stod(line.substr(line.find(" at ") + 4));
}

nlohmann::json results(Bench& bench) {
    return nlohmann::json::parse(bench.node().finish()).at("faults");
}

}  // namespace

TEST_CASE("read_error: the chosen reads fail with the errno given, the bytes come with the next") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        RandomStream random(seed, "test");
        const auto skip = random.below(5);
        const std::string name = std::array{"EAGAIN", "EIO", "EINTR"}[random.below(3)];
        FaultSpec spec = fault("read_error").set("errno", name);
        spec.skip = skip;
        spec.count = 2;
        Bench bench(suffering({"read", "8", "16"}, {spec}));
        for (int i = 0; i < 6; ++i)
            bench.send((50 + 20 * i) * kMillisecond, static_cast<std::uint8_t>('a' + i));
        bench.run(300 * kMillisecond);
        INFO("seed " << seed << "\n" << bench.log());
        const auto told = lines(bench);
        REQUIRE(told.size() == 8);
        for (std::size_t i = 0; i < 8; ++i) {
            const bool fails = i >= skip && i < skip + 2;
            CHECK(without_time(told[i]) == (fails ? "read -1 " + name : "read 1 "));
        }
        const auto report = results(bench);
        CHECK(report[0]["fired"] == 2);
        CHECK(report[0]["firings"].size() == 2);
    }
}

TEST_CASE("short_read and short_write move fewer bytes, the rest is not lost") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        RandomStream random(seed, "test");
        const auto most = static_cast<int>(1 + random.below(6));
        const int length = most + 1 + static_cast<int>(random.below(20));
        Bench reader(suffering({"read", "4", "32"}, {fault("short_read").set("most", most)}));
        reader.send(50 * kMillisecond, std::string(static_cast<std::size_t>(4 * most), 'x'));
        reader.run(300 * kMillisecond);
        INFO("seed " << seed << "\n" << reader.log());
        REQUIRE(lines(reader).size() == 4);
        for (const std::string& line : lines(reader))
            CHECK(std::stoi(line.substr(5)) <= most);
        CHECK(results(reader)[0]["fired"] == 4);

        FaultSpec spec = fault("short_write").set("most", most);
        spec.every = 2;
        Bench writer(suffering({"write", "4", std::to_string(length)}, {spec}));
        writer.run(300 * kMillisecond);
        const auto told = lines(writer);
        REQUIRE(told.size() == 4);
        for (std::size_t i = 0; i < 4; ++i)
            CHECK(without_time(told[i]) == fmt::format("write {} ", i % 2 == 0 ? most : length));
        CHECK(writer.sent().size() == static_cast<std::size_t>(2 * most + 2 * length));
    }
}

TEST_CASE("write_error: nothing goes out") {
    FaultSpec spec = fault("write_error").set("errno", "EIO");
    spec.begin = 15 * kMillisecond;
    spec.end = 25 * kMillisecond;
    Bench bench(suffering({"write", "4", "3"}, {spec}));
    bench.run(300 * kMillisecond);
    const auto told = lines(bench);
    REQUIRE(told.size() == 4);
    CHECK(without_time(told[1]) == "write 3 ");
    CHECK(without_time(told[2]) == "write -1 EIO");
    CHECK(bench.sent().size() == 9);
}

TEST_CASE("termios_refused and termios_baud: what takes effect is not what was asked for") {
    const auto set = [](std::vector<FaultSpec> faults) {
        Bench bench(suffering({"set"}, std::move(faults)));
        bench.run(300 * kMillisecond);
        return lines(bench).at(0) + bench.sent();
    };
    CHECK(set({}) == "0 baud 1 parity 1 stop 1U");
    CHECK(set({fault("termios_refused").set("setting", "parity")}) == "0 baud 1 parity 0 stop 1U");
    CHECK(set({fault("termios_refused").set("setting", "stop_bits")}) == "0 baud 1 parity 1 stop 0U");
    CHECK(set({fault("termios_refused").set("setting", "baud")}) == "0 baud 0 parity 1 stop 1U");
    CHECK(set({fault("termios_baud").set("baud", 57600)}) == "0 baud 1 parity 1 stop 1U");  // and yet:
    Bench bench(suffering({"read", "1", "1"}, {fault("termios_baud").set("baud", 57600)}));
    Bench right(suffering({"read", "1", "1"}, {}));
    for (Bench* one : {&bench, &right})
        one->send(50 * kMillisecond, 'U', 57600.0);
    bench.run(100 * kMillisecond);
    right.run(100 * kMillisecond);
    CHECK(nlohmann::json::parse(bench.node().finish())["uart"]["framing_errors"] == 0);
    CHECK(nlohmann::json::parse(right.node().finish())["uart"]["framing_errors"] > 0);
}

TEST_CASE("i2c_error: transfers fail with the errno given and never reach the bus") {
    for (const char* const name : {"EIO", "EAGAIN", "ETIMEDOUT", "ENXIO", "EBUSY", "EREMOTEIO"}) {
        FaultSpec spec = fault("i2c_error").set("errno", name).set("address", 0x20);
        spec.every = 3;
        Bench bench(suffering({"i2c", "6", "0x20"}, {spec}));
        bench.add_device(0x20, {{1, 77}});
        bench.run(300 * kMillisecond);
        INFO(bench.log());
        const auto told = lines(bench);
        REQUIRE(told.size() == 6);
        for (std::size_t i = 0; i < 6; ++i)
            CHECK(without_time(told[i]) ==
                  (i % 3 == 0 ? fmt::format("transfer -1 {}", name) : "transfer 77 "));
        CHECK(results(bench)[0]["fired"] == 2);
    }
    Bench other(suffering({"i2c", "2", "0x21"}, {fault("i2c_error").set("address", 0x20)}));
    other.add_device(0x21, {{1, 5}});
    other.run(100 * kMillisecond);
    CHECK(lines(other).at(0).starts_with("transfer 5 "));
    CHECK(results(other)[0]["fired"] == 0);
}

TEST_CASE("pause: no call is made meanwhile, however grants are cut, and bytes wait in the driver") {
    for (unsigned seed = 1; seed <= 3; ++seed) {
        RandomStream random(seed, "test");
        const Time at = 20 * kMillisecond + static_cast<Time>(random.below(20 * kMillisecond));
        const Time length = 15 * kMillisecond + static_cast<Time>(random.below(30 * kMillisecond));
        FaultSpec spec = fault("pause").set("time", to_seconds(length));
        spec.begin = at;
        std::set<std::string> logs, traces;
        for (const Time slice : {70 * kMicrosecond, 33 * kMicrosecond, 7 * kMicrosecond}) {
            Bench bench(suffering({"tick", "12"}, {spec}), slice);
            bench.run(300 * kMillisecond);
            double before = 0, longest = 0;
            for (const std::string& line : lines(bench)) {
                const double ms = time_of(line);
                INFO("seed " << seed << " at " << at << " for " << length << "\n" << bench.log());
                CHECK((ms <= to_seconds(at) * 1e3 + 0.1 || ms >= to_seconds(at + length) * 1e3 - 0.1));
                longest = std::max(longest, ms - before);
                before = ms;
            }
            CHECK(longest >= to_seconds(length) * 1e3 - 0.2);
            CHECK(lines(bench).size() == 12);
            CHECK(results(bench)[0]["fired"] == 1);
            logs.insert(bench.log());
            traces.insert(bench.trace());
        }
        CHECK(logs.size() == 1);
        CHECK(traces.size() == 1);
    }
    FaultSpec spec = fault("pause").set("time", 0.1);
    spec.begin = 40 * kMillisecond;
    Bench bench(suffering({"read", "2", "32"}, {spec}));
    bench.send(50 * kMillisecond, "abcdef");
    bench.send(180 * kMillisecond, "g");
    bench.run(300 * kMillisecond);
    const auto told = lines(bench);
    REQUIRE(told.size() == 2);
    CHECK(told[0] == "read 6  at 140.0 ms");
    CHECK(without_time(told[1]) == "read 1 ");
}

TEST_CASE("starve: within the window each call costs so many times as much") {
    FaultSpec spec = fault("starve").set("factor", 1000);
    spec.begin = 25 * kMillisecond;
    spec.end = 75 * kMillisecond;
    Bench plain(suffering({"tick", "10"}, {})), starved(suffering({"tick", "10"}, {spec}));
    plain.run(kSecond);
    starved.run(kSecond);
    REQUIRE(lines(starved).size() == 10);
    CHECK(time_of(lines(plain)[9]) == Approx(90.1).margin(0.2));
    CHECK(time_of(lines(starved)[2]) == time_of(lines(plain)[2]));
    CHECK(time_of(lines(starved)[9]) > time_of(lines(plain)[9]) + 3);
    const double last = time_of(lines(starved)[9]) - time_of(lines(starved)[8]);
    CHECK(last == Approx(10.0).margin(0.1));  // as before again
}

TEST_CASE("kill and restart") {
    FaultSpec kill = fault("kill");
    kill.begin = 35 * kMillisecond;
    Bench ends(suffering({"tick", "100"}, {kill}));
    ends.run(kSecond);
    CHECK(lines(ends).size() == 4);
    REQUIRE(ends.node().stop());
    CHECK_FALSE(ends.node().stop()->success);
    CHECK(ends.node().stop()->reason.find("killed by a fault") != std::string::npos);
    CHECK(ends.node().stop()->time == kill.begin);
    CHECK(results(ends)[0]["fired"] == 1);

    kill.set("run", "goes_on");
    Bench goes_on(suffering({"tick", "100"}, {kill}));
    goes_on.run(kSecond);
    CHECK(lines(goes_on).size() == 4);
    CHECK_FALSE(goes_on.node().stop());

    FaultSpec restart = fault("restart").set("down", 0.02);
    restart.begin = 35 * kMillisecond;
    restart.period = 100 * kMillisecond;
    restart.count = 2;
    Bench again(suffering({"tick", "8"}, {restart}));
    again.run(kSecond);
    const auto told = lines(again);
    INFO(again.log());
    REQUIRE(told.size() == 4 + 8 + 8);  // the second one finds it in its last ticks
    CHECK(told[4].starts_with("tick 0 "));
    CHECK(time_of(told[4]) == Approx(55.0).margin(0.2));
}

TEST_CASE("hang_up: reads end with nothing, writes fail with EIO") {
    FaultSpec spec = fault("hang_up");
    spec.begin = 25 * kMillisecond;
    Bench bench(suffering({"write", "4", "3"}, {spec}));
    bench.run(300 * kMillisecond);
    REQUIRE(lines(bench).size() == 4);
    CHECK(without_time(lines(bench)[2]) == "write 3 ");
    CHECK(without_time(lines(bench)[3]) == "write -1 EIO");
}

TEST_CASE("each errno that a fault can give is one") {
    for (const KindInfo& kind : all_kinds()) {
        if (kind.place != PlaceKind::Linux) continue;
        for (const ParameterInfo& parameter : kind.parameters) {
            if (parameter.key != "errno") continue;
            std::istringstream names{std::string(parameter.choices)};
            for (std::string name; std::getline(names, name, '|');) {
                FaultSpec spec = fault(std::string(kind.name)).set("errno", name);
                linuxboard::LinuxFaults faults(suffering({"tick", "1"}, {spec}).faults);
                const int error = kind.name == "read_error"    ? faults.read(1, 1).error
                                  : kind.name == "write_error" ? faults.write(1, 1).error
                                                               : faults.transfer(1, {0x20});
                REQUIRE(error != 0);
                CHECK(name == strerrorname_np(error));
            }
        }
    }
    FaultSpec unknown = fault("melt");
    CHECK_THROWS_AS(linuxboard::LinuxFaults({{unknown, Trigger(unknown, fault_stream(unknown, 1, 0))}}),
                    InputError);
}

TEST_CASE("dns_silence: a resolver asks again, and gives up when no question is answered") {
    FaultSpec spec = fault("dns_silence").set("timeout", 5.0).set("attempts", 2.0);
    spec.begin = 10 * kSecond;
    spec.end = 30 * kSecond;
    linuxboard::LinuxFaults faults({{spec, Trigger(spec, fault_stream(spec, 1, 0))}});
    const auto at = [&](int seconds) {
        const auto result = faults.resolve(seconds * kSecond, "server");
        return std::pair(result.until / kSecond - seconds, result.failed);
    };
    CHECK(at(9) == std::pair(Time{0}, false));
    CHECK(at(10) == std::pair(Time{10}, true));
    CHECK(at(24) == std::pair(Time{10}, true));  // asked at 24 and 29 s
    CHECK(at(26) == std::pair(Time{5}, false));  // at 26 and 31 s
    CHECK(at(30) == std::pair(Time{0}, false));
    const auto& evidence = faults.carried()[0].evidence;
    CHECK(evidence.fired() == 3);
    CHECK(evidence.firings()[0].what == "server is not answered for 10.000 s");
    CHECK(evidence.firings()[2].what == "server is not answered for 5.000 s and then is");
    CHECK(linuxboard::LinuxFaults::concern_names(faults.carried()));
    CHECK_FALSE(linuxboard::LinuxFaults::concern_names({}));
}
