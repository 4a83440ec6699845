// `puckloop bench`, `bench bluetooth` and `bench sound` as their users meet them: what can be measured is
// explained, what is missing is named before any work, results are where they were asked for.

#include "tests/kit/files.h"
#include "tests/kit/scratch.h"
#include "tests/tools/shell.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <sstream>

using namespace puckloop::tests;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

long lines_of(const fs::path& file) {
    const std::string text = text_of(file);
    return std::count(text.begin(), text.end(), '\n');
}

void check_refused(const std::string& arguments, const std::string& expected) {
    const Ran result = run_puckloop(arguments);
    INFO(result.output);
    CHECK(result.status == 2);
    CHECK(std::count(result.output.begin(), result.output.end(), '\n') == 1);
    CHECK_THAT(result.output, Contains(expected));
}

}  // namespace

TEST_CASE("help on a command that there is not is refused") {
    check_refused("snapshott --help", "unknown command 'snapshott'");
    CHECK(run_puckloop("--help").status == 0);
    CHECK(run_puckloop("run --help").status == 0);
}

TEST_CASE("upload: --baud is the port's rate, and a script leaves each row its time on the line") {
    const std::string image = std::string(PUCKLOOP_SOURCE) + "/firmware/bluetooth/talk.hex";
    const int port = ::posix_openpt(O_RDWR | O_NOCTTY);
    REQUIRE(port >= 0);
    REQUIRE(::grantpt(port) == 0);
    REQUIRE(::unlockpt(port) == 0);
    const std::string name = ::ptsname(port);
    for (const auto& [option, rate] :
         {std::pair<std::string, speed_t>{"--baud 9600", B9600}, {"--baud 57600", B57600}, {"", B115200}}) {
        INFO(option);
        const Ran nobody = run_puckloop("upload " + image + " " + name + " --wait 0.1 " + option);
        CHECK(nobody.status == 1);
        termios settings{};
        REQUIRE(::tcgetattr(port, &settings) == 0);
        CHECK(cfgetospeed(&settings) == rate);
    }
    ::close(port);
    const auto spaced = [&](const std::string& option) {
        const fs::path file = scratch_path("rows.txt");
        fs::remove(file);
        REQUIRE(run_puckloop("upload " + image + " --script " + file.string() + option).status == 0);
        std::istringstream lines(text_of(file));
        std::vector<double> times;
        for (std::string line; std::getline(lines, line);)
            times.push_back(std::stod(line));
        return times.at(3) - times.at(2);
    };
    constexpr double kBits = 10 * 101;
    CHECK(spaced("") == Approx(0.025).margin(0.001));
    CHECK(spaced(" --baud 9600") > kBits / 9600 + 0.004);
    CHECK(spaced(" --baud 38400") > kBits / 38400 + 0.004);
    check_refused("upload " + image + " /dev/null --baud 0", "--baud");
}

TEST_CASE("the help of puckloop bench explains every case on a line of its own") {
    const Ran help = run_puckloop("bench --help");
    REQUIRE(help.status == 0);
    std::smatch list;
    // The list is broken into lines of 100 columns.
    const std::string joined = std::regex_replace(help.output, std::regex(",\n +"), ",");
    REQUIRE(std::regex_search(joined, list, std::regex("--case\\s+\\{([a-z0-9,]+)\\}")));
    // "  wait      main boards whose ..."
    const auto explained = [&](const std::string& name) {
        std::istringstream lines(help.output);
        for (std::string line; std::getline(lines, line);) {
            line.erase(0, line.find_first_not_of(' '));
            if (line.starts_with(name + "  ")) return line.find_last_not_of(' ') > name.size() + 10;
        }
        return false;
    };
    std::istringstream names(list[1]);
    int cases = 0;
    for (std::string name; std::getline(names, name, ','); ++cases) {
        INFO(name);
        CHECK(explained(name));
    }
    CHECK(cases >= 14);
}

TEST_CASE("benchmarks with robots ask for the program that they need", "[bluetooth]") {
    check_refused("bench bluetooth --exchanges 1 --out /proc/nowhere", "/proc/nowhere: cannot be made: ");
    check_refused("upload " PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex --script /nowhere/x",
                  "/nowhere/x: --script: cannot be written: No such file");
    check_refused("bench --scenario /nowhere.toml", "/nowhere.toml: --scenario: no such file");
    check_refused("bench bluetooth --boards", "--boards and --firmware IMAGE");
    check_refused("bench bluetooth --firmware x.hex", "--boards and --firmware IMAGE");
    check_refused("bench bluetooth --boards --firmware nowhere.hex --out " + scratch_path("refused").string(),
                  "nowhere.hex");
    check_refused("bench sound --experiment radio", "--radio IMAGE");
    check_refused("bench sound --radio x.hex", "--firmware IMAGE");
    check_refused("bench network --robots 1", "--robots");
    check_refused("bench network --robots 2 --runs 1 --firmware nowhere.hex --out " +
                      scratch_path("refused_team").string(),
                  "nowhere.hex");
}

TEST_CASE("exchanges of modules and of boards are tabled, drawn and listed", "[bluetooth]") {
    const fs::path out = scratch_path("bench_bluetooth");
    const Ran drawn = run_puckloop(fmt::format("bench bluetooth --exchanges 300 --out {}", out.string()));
    INFO(drawn.output);
    REQUIRE(drawn.status == 0);
    CHECK_THAT(drawn.output, Contains("attempts                               300                58\n"));
    CHECK_THAT(drawn.output, Contains("3.7 to 18.6 %\n"));
    CHECK(lines_of(out / "exchanges.csv") == 301);
    CHECK_THAT(text_of(out / "exchanges.svg"), Contains("drawn: 300 attempts"));
    const Ran boards = run_puckloop(fmt::format(
        "bench bluetooth --boards --firmware {}/firmware/bluetooth/talk.hex --exchanges 3 --out {}",
        PUCKLOOP_SOURCE, out.string()));
    INFO(boards.output);
    REQUIRE(boards.status == 0);
    CHECK_THAT(boards.output, Contains("talk.hex"));
    CHECK(lines_of(out / "exchanges.csv") == 4);
    CHECK_THAT(text_of(out / "exchanges.svg"), Contains("talk.hex: 3 attempts"));
}

TEST_CASE("teams' pause times are tabled, drawn and listed", "[network]") {
    const fs::path out = scratch_path("bench_network");
    const Ran result = run_puckloop(fmt::format(
        "bench network --robots 2 --robots 3 --runs 1 --duration 12 --forwarder puckloop-forward --out {}",
        out.string()));
    INFO(result.output);
    REQUIRE(result.status == 0);
    CHECK_THAT(result.output, Contains("0 of 8 packets lost (published: 0 of 2000)"));
    CHECK(lines_of(out / "pauses.csv") == 9);
    CHECK_THAT(text_of(out / "pauses.svg"), Contains("802.11g, 1 runs of 12 s"));
}

TEST_CASE("a short walk with ears and radio leaves its table and pictures", "[bluetooth][sound]") {
    const fs::path out = scratch_path("bench_radio");
    const Ran result = run_puckloop(
        fmt::format("bench sound --experiment radio --radio {}/firmware/ears/ears.hex --walk 8 --out {}",
                    PUCKLOOP_SOURCE, out.string()));
    INFO(result.output);
    REQUIRE(result.status == 0);
    CHECK_THAT(result.output, Contains("messages arrived (published: 58, 53)"));
    CHECK(lines_of(out / "radio.csv") >= 2);
    CHECK_THAT(text_of(out / "radio.svg"), Contains("</svg>"));
    CHECK_THAT(text_of(out / "radio_times.svg"), Contains("ears.hex: "));
}
