// TAMs of a scenario become nodes and links.

#include "base/error.h"
#include "base/json.h"
#include "run/factory/node_factory.h"
#include "run/factory/preflight.h"
#include "run/setup.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <stdexcept>

using namespace puckloop;
using nlohmann::json;

namespace {

tools::RunRequest request_of(const std::string& more) {
    const auto file = tests::scratch_path("tam-setup.toml");
    std::ofstream(file) << "[run]\nduration = \"1 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n"
                           "[[tam]]\nposition = [\"0 m\", \"0 m\"]\n" +
                               more;
    tools::RunRequest request;
    request.scenario = file;
    return request;
}

const tools::NodeDescription& node(const tools::RunSetup& setup, const std::string& name) {
    for (const auto& one : setup.nodes)
        if (one.name == name) return one.what;
    throw std::out_of_range(name);
}

const tam::TamSpec& tam_of(const tools::RunSetup& setup) {
    return std::get<tam::TamSpec>(node(setup, "tam0.avr").kind);
}

}  // namespace

TEST_CASE("a TAM is a node with a link to the world") {
    tools::RunRequest request = request_of("network = 1\nstart = \"2 s\"\n");
    request.firmware = {"tam0=/x/y.elf"};
    const tools::RunSetup setup = tools::set_up(request);
    const tam::TamSpec& tam = tam_of(setup);
    CHECK(tam.firmware == "/x/y.elf");
    CHECK(tam.network == 1);
    CHECK(tam.start == 2.0);
    const auto& world = std::get<tools::WorldSpec>(node(setup, "world").kind).world;
    CHECK(world.booths.at(0).signals.contains("barrier_back"));
    bool linked = false;
    for (const auto& link : setup.links)
        linked |= link.a.node == "tam0.avr" && link.a.port == "world" && link.b.port == "tam0";
    CHECK(linked);
    request.firmware = {"tam=/x/z.elf"};
    CHECK(tam_of(tools::set_up(request)).firmware == "/x/z.elf");
    request.firmware = {"tam1=/x/z.elf"};
    CHECK_THROWS_WITH(tools::set_up(request), Catch::Contains("no board 'tam1' (expected one of tam0,"));
}

TEST_CASE("the console takes what is plugged in, and a live end only in real time") {
    tools::RunRequest request = request_of("console = \"pty\"\n");
    request.firmware = {"tam=/x/y.elf"};
    CHECK_THROWS_WITH(tools::set_up(request), Catch::Contains("tam0.console: 'pty' has a clock of its own"));
    request.realtime = true;
    const tools::RunSetup setup = tools::set_up(request);
    CHECK(std::get<tools::OutsideSpec>(node(setup, "tam0.console").kind).baud == 57600.0);
}

TEST_CASE("an image that is not for the chip is refused before the run") {
    const auto file = tests::scratch_path("not-avr.elf");
    std::ofstream(file) << "no image";
    tools::RunRequest request = request_of("");
    request.firmware = {"tam0=" + file.string()};
    CHECK_THROWS_AS(tools::check_files(tools::set_up(request)), InputError);
    request.firmware = {"tam0=/nowhere/x.elf"};
    CHECK_THROWS_WITH(tools::check_files(tools::set_up(request)), Catch::Contains("/nowhere/x.elf"));
}

TEST_CASE("a boot loader lies below the firmware, whose first bytes it does not spoil") {
    const auto hex = [](const std::string& name, const std::string& text) {
        const auto file = tests::scratch_path(name);
        std::ofstream(file) << text << ":00000001FF\n";
        return file.string();
    };
    // At 0x1FC00 a jump to 0, and two stray bytes at 0 as optiboot's file has them; the firmware sets PD7.
    const std::string boot = hex("boot.hex", ":020000000504F5\n:020000040001F9\n:04FC00000C94000060\n");
    const std::string firmware = hex("firmware.hex", ":0800000080E88AB98BB9FFCF3B\n");
    tools::RunRequest request = request_of("boot_loader = \"" + boot + "\"\n[coordinator]\n");
    request.firmware = {"tam0=" + firmware};
    const tools::RunSetup setup = tools::set_up(request);
    CHECK_NOTHROW(tools::check_files(setup));
    const auto board = tools::make_board(tools::without_files(node(setup, "tam0.avr")));
    std::vector<cosim::Message> sent;
    board->advance(cosim::kMillisecond, {}, sent);
    REQUIRE(sent.size() == 1);  // the module's reset
    const json report = json::parse(board->finish());
    CHECK(report["fuses"]["high"] == "0xDE");
    CHECK(report["warnings"].empty());
}
