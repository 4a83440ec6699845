// State files: whole or not at all, refused with one line when damaged or of another format.

#include "cosim/resume/state_file.h"

#include "base/error.h"
#include "base/random.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

using namespace puckloop;
using namespace puckloop::cosim;

namespace {

StateFile example() {
    BoardState state;
    state.board = {"robot0.pic", "e-puck main board", "dsPIC30F6014A", "abc", "{}"};
    state.time = 40 * kSecond;
    UartFrame frame;
    frame.start = 5;
    frame.bit_period = 8'680'556;
    state.received = {{7, 3, Signal{2, -1.5}}, {9, 0, frame}};
    state.sent = {{8, 2, I2cPhase{I2cPhaseKind::Write, 3, 0, 8, 10'000'000, 0}}};
    state.memory = {1, 2, 3};
    return {"build", {state, state}};
}

std::string problem(const std::vector<std::uint8_t>& bytes) {
    try {
        decode(bytes, "x.state");
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_CASE("a state file comes back as it was written") {
    const auto path = tests::scratch_path("boards.state");
    const StateFile file = example();
    write_state_file(path, file);
    struct stat info {};
    REQUIRE(::stat(path.c_str(), &info) == 0);
    CHECK((info.st_mode & 0777) == 0600);
    const StateFile read = read_state_file(path);
    std::filesystem::remove(path);
    CHECK(read.build == "build");
    REQUIRE(read.boards.size() == 2);
    CHECK(read.boards[1].board == file.boards[1].board);
    CHECK(read.boards[1].time == file.boards[1].time);
    CHECK((read.boards[1].received == file.boards[1].received));
    CHECK((read.boards[1].sent == file.boards[1].sent));
    CHECK(read.boards[1].memory == file.boards[1].memory);
    CHECK(encode(read) == encode(file));
}

TEST_CASE("damaged state files are refused with one line") {
    const auto good = encode(example());
    CHECK(problem(good).empty());
    CHECK(problem({}) == "x.state: is no state file (expected a file written by --save-state)");
    auto other = good;
    other[25] = kStateFormat + 1;
    CHECK(problem(other).find("x.state: a state of format 2, from another version (expected format 1") == 0);
    RandomStream random(9, "state file");
    for (int i = 0; i < 3000; ++i) {
        auto bytes = good;
        if (random.below(3) == 0)
            bytes.resize(random.below(bytes.size()));
        else
            bytes[random.below(bytes.size())] ^= static_cast<std::uint8_t>(1 + random.below(255));
        const std::string line = problem(bytes);
        REQUIRE(!line.empty());
        REQUIRE(line.find('\n') == std::string::npos);
    }
    CHECK_THROWS_AS(read_state_file("/nonexistent/x.state"), InputError);
    CHECK_THROWS_AS(read_state_file("/"), InputError);
    CHECK_THROWS_AS(write_state_file("/nonexistent/x.state", example()), RunError);
}

TEST_CASE("the program knows its build") {
    CHECK(build_id().size() >= 16);
}
