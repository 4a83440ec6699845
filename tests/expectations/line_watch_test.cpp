// Bytes that are looked for on serial lines, as they pass.

#include "run/expectations/line_watch.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::tools;
using scenarios::Expectation;

namespace {

struct Line {
    std::vector<Expectation> expected;
    LineWatch watch;

    explicit Line(Expectation one) : expected{std::move(one)}, watch(expected) {
        watch.begin({{.name = "other", .a = {"x", "u"}, .b = {"y", "u"}, .nominal_baud = 1e5},
                     {.name = "robot0.uart",
                      .a = {"robot0.linux", "u"},
                      .b = {"robot0.pic", "u"},
                      .nominal_baud = 1e5}});
    }
    /// Bytes a millisecond apart from `ms` on.
    void carry(int ms, const std::string& bytes, cosim::Direction direction = cosim::Direction::FromA,
               std::uint16_t link = 1, cosim::FaultKind fault = cosim::FaultKind::None) {
        for (const char c : bytes)
            watch.record({.time = ms++ * cosim::kMillisecond,
                          .link = link,
                          .direction = direction,
                          .fault = fault,
                          .payload = cosim::UartFrame{.data = static_cast<unsigned char>(c)}});
    }
};

Expectation bytes(const std::string& text) {
    Expectation one;
    one.kind = Expectation::Kind::Line;
    one.subject = "robot0.uart";
    one.text = text;
    return one;
}

}  // namespace

TEST_CASE("bytes are found where they follow each other in one direction of one line") {
    Line line(bytes("aab"));
    REQUIRE(line.watch.watches());
    line.carry(10, "aa");
    line.carry(12, "b", cosim::Direction::FromB);
    line.carry(13, "b", cosim::Direction::FromA, 0);
    line.carry(14, "b", cosim::Direction::FromA, 1, cosim::FaultKind::Drop);
    CHECK_FALSE(line.watch.seen_at(0));
    line.carry(15, "aab");  // behind "aa": the first of them is not part of it
    CHECK(line.watch.seen_at(0) == 0.017);
    line.carry(20, "aab");
    CHECK(line.watch.seen_at(0) == 0.017);
}

TEST_CASE("bytes count within the time and from the end that the table states") {
    Expectation one = bytes("x");
    one.after = 0.010;
    one.by = 0.020;
    one.from = "robot0.pic";
    Line line(one);
    line.carry(9, "x", cosim::Direction::FromB);
    line.carry(15, "x", cosim::Direction::FromA);
    line.carry(21, "x", cosim::Direction::FromB);
    CHECK_FALSE(line.watch.seen_at(0));
    line.carry(20, "x", cosim::Direction::FromB);
    CHECK(line.watch.seen_at(0) == 0.020);
}

TEST_CASE("what came in place of the bytes is known: how many, and the last of them") {
    Expectation one = bytes("zz");
    one.from = "robot0.linux";
    one.after = 0.011;
    Line line(one);
    CHECK(line.watch.what_came(0) == "no byte came");
    line.carry(10, "ab");
    line.carry(12, "c", cosim::Direction::FromB);
    CHECK(line.watch.what_came(0) == "1 byte came, the last 62");
    line.carry(13, "0123456789abcd");
    CHECK(line.watch.what_came(0) == "15 bytes came, the last 32 33 34 35 36 37 38 39 61 62 63 64");
}
