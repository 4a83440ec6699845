// A range-and-bearing board that goes on while light is not known yet, up to where its program looks, is the
// board that knew everything: messages, log, report and every byte of its saved state. Own firmware, real
// images (PUCKLOOP_IMAGES) and random programs; light becomes known at random times.

#include "emu/rab_board/rab_node.h"
#include "tests/kit/node_under_test.h"
#include "tests/kit/scratch.h"
#include "tests/state/board_runs.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::Message;
using cosim::Time;

namespace {

constexpr Time kLongest = 300 * cosim::kMicrosecond;  ///< of a grant, and of what is known at once

std::unique_ptr<rab::RabNode> board(const image::Image& image, const std::string& log) {
    rab::RabNodeOptions options;
    options.board.name = "robot0.rab";
    options.log = log;
    return std::make_unique<rab::RabNode>(image, options);
}

Time within(RandomStream& random, Time longest) {
    return 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(longest)));
}

/// Light at every receiver, with what random_inputs() has.
std::vector<Message> inputs(RandomStream& random, Time end) {
    constexpr double kBusy = 2000;
    std::vector<Message> all = random_inputs(random, 0, end, kBusy, kRabSignals);
    for (Time at = 0; at < end; at += within(random, 60 * cosim::kMicrosecond)) {
        const bool peak = random.below(2) == 0;
        const auto id = static_cast<std::uint16_t>((peak ? rab::kPeak : rab::kDemodulator) +
                                                   random.below(rab::kSensorCount));
        const double value = static_cast<double>(random.below(peak ? 4096 : 2));
        all.push_back({at, rab::RabNode::kIr, cosim::Signal{id, value}});
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    return all;
}

struct Sampled {
    std::uint64_t ahead = 0;  ///< advances that came further than light was known
    std::uint64_t held = 0;   ///< that ended before a look
};

/// Light comes as late as `known` has it, anything else in time.
std::vector<Message> run_sampling(RandomStream& random, rab::RabNode& node, std::vector<Message> inbox,
                                  Time end, Sampled& sampled) {
    std::vector<Message> outbox;
    Time reached = 0, known = 0;
    while (reached < end || known < end) {
        known = std::min(end, known + within(random, kLongest));
        const Time until = std::min(end, reached + within(random, kLongest));
        std::vector<Message> now;
        std::copy_if(inbox.begin(), inbox.end(), std::back_inserter(now), [&](const Message& message) {
            return message.time < until && (message.port != rab::RabNode::kIr || message.time < known);
        });
        reached = node.advance_sampling({until, known, until}, now, outbox);
        REQUIRE(reached == node.granted());
        if (reached < until) REQUIRE(reached >= known);
        sampled.ahead += reached > known ? 1 : 0;
        sampled.held += reached < until ? 1 : 0;
        std::erase_if(inbox, [&](const Message& message) {
            return message.time < reached && (message.port != rab::RabNode::kIr || message.time < known);
        });
    }
    return outbox;
}

std::vector<Message> by_port(std::vector<Message> messages) {
    std::stable_sort(messages.begin(), messages.end(),
                     [](const Message& a, const Message& b) { return a.port < b.port; });
    return messages;
}

Sampled check(const image::Image& image, Time end, std::uint64_t seed, const std::string& name) {
    INFO(name << ", seed " << seed);
    RandomStream random(seed, "sampled light");
    const std::string known_log = scratch_path("known.log"), sampling_log = scratch_path("sampling.log");
    const std::vector<Message> inbox = inputs(random, end);
    const auto known = board(image, known_log), sampling = board(image, sampling_log);
    std::vector<Message> sent;
    auto next = inbox.begin();
    for (const Time cut : random_cuts(random, kLongest, end)) {
        const auto last = std::find_if(next, inbox.end(), [&](const Message& m) { return m.time >= cut; });
        known->advance(cut, {next, last}, sent);
        next = last;
    }
    Sampled sampled;
    const bool same_messages = by_port(run_sampling(random, *sampling, inbox, end, sampled)) == by_port(sent);
    REQUIRE(same_messages);
    REQUIRE(same_future(*known, *sampling));
    const bool same_bytes = saved(*known) == saved(*sampling);
    REQUIRE(same_bytes);
    CHECK(known->finish() == sampling->finish());
    CHECK(contents(known_log) == contents(sampling_log));
    return sampled;
}

}  // namespace

TEST_CASE("own firmware samples light that becomes known late") {
    const Sampled sampled = check(own_rab_image(), 120 * cosim::kMillisecond, 1, "rab.hex");
    CHECK(sampled.ahead > 10);
    CHECK(sampled.held > 10);
}

TEST_CASE("real firmware samples light that becomes known late") {
    const auto image = real_image("randb.hex");
    if (!image) return;
    const Sampled sampled = check(*image, 150 * cosim::kMillisecond, 1, "randb.hex");
    CHECK(sampled.ahead > 30);
    CHECK(sampled.held > 30);
}

TEST_CASE("random programs sample light that becomes known late") {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        RandomStream random(seed, "random programs that sample");
        check(random_program(random, true), 8 * cosim::kMillisecond, seed, "random program");
    }
    check(self_programming(true), 20 * cosim::kMillisecond, 1, "self-programming");
}
