#include "run/factory/outside_node.h"

#include "base/error.h"
#include "base/random.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <unistd.h>

using namespace puckloop;
using namespace puckloop::tools;

namespace {

/// A folder of its own for one test.
class Folder {
  public:
    Folder()
        : path_(std::filesystem::temp_directory_path() / ("puckloop_outside_" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    std::string file(const std::string& name) const { return (path_ / name).string(); }
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

OutsideSpec scripted(const Folder& folder, const std::string& script) {
    std::ofstream(folder.file("in.txt")) << script;
    return {"robot0.uart1", parse_outside("uart1", "script:in.txt", folder.path()), 115200.0,
            folder.file("received")};
}

/// Everything that the node sends within 20 ms, grants cut at random.
std::vector<cosim::Message> sent_by(OutsideNode& node, std::uint64_t seed) {
    RandomStream random(seed, "grants");
    std::vector<cosim::Message> outbox;
    for (cosim::Time until = 0; until < 20 * cosim::kMillisecond;) {
        until += 1 + static_cast<cosim::Time>(random.below(700 * cosim::kMicrosecond));
        const cosim::Time earliest = node.earliest_output(0);
        const std::size_t before = outbox.size();
        node.advance(until, {}, outbox);
        for (std::size_t i = before; i < outbox.size(); ++i)
            CHECK(outbox[i].time >= earliest);
    }
    return outbox;
}

}  // namespace

TEST_CASE("a script's bytes leave at their times, back to back where they are close") {
    const Folder folder;
    const OutsideSpec spec = scripted(folder, "0.010 41\n0.001 56 0d\n");
    OutsideNode node(spec);
    const auto sent = sent_by(node, 1);
    REQUIRE(sent.size() == 3);
    const auto frame = [&](std::size_t i) { return std::get<cosim::UartFrame>(sent[i].payload); };
    CHECK(frame(0).data == 0x56);
    CHECK(frame(0).start == cosim::kMillisecond);
    CHECK(frame(1).data == 0x0D);
    CHECK(frame(1).start == frame(0).start + 10 * frame(0).bit_period);
    CHECK(frame(2).start == 10 * cosim::kMillisecond);
    OutsideNode again(spec);
    CHECK(sent_by(again, 2) == sent);
    CHECK(node.earliest_output(0) == cosim::kNever);
}

TEST_CASE("what the robot sends is kept, garbage of a wrong rate counted") {
    const Folder folder;
    OutsideNode node(scripted(folder, "1 00\n"));
    std::vector<cosim::Message> inbox, outbox;
    const cosim::Time bit = 8'680'556;
    inbox.push_back(
        {cosim::kMillisecond, 0,
         cosim::UartFrame{.start = cosim::kMillisecond - 9 * bit, .bit_period = bit, .data = 'o'}});
    inbox.push_back({3 * cosim::kMillisecond, 0,
                     cosim::UartFrame{.start = 2 * cosim::kMillisecond, .bit_period = 12 * bit, .data = 0}});
    node.advance(5 * cosim::kMillisecond, inbox, outbox);
    const std::string report = node.finish();
    CHECK(report.find("\"framing_errors\":0") == std::string::npos);
    std::ifstream file(folder.file("received"), std::ios::binary);
    CHECK(file.get() == 'o');
}

TEST_CASE("ends that a run cannot have are refused") {
    CHECK_THROWS_WITH(parse_outside("robot0.uart1", "-", "."), Catch::Contains("no standard input"));
    CHECK_THROWS_AS(parse_outside("robot0.uart1", "modem", "."), InputError);
    const Folder folder;
    CHECK_THROWS_WITH(OutsideNode(scripted(folder, "0.1 5z\n")), Catch::Contains("in.txt: line 1"));
    OutsideSpec missing = scripted(folder, "0 00\n");
    missing.end.file = folder.file("nowhere.txt");
    CHECK_THROWS_AS(OutsideNode(missing), InputError);
}
