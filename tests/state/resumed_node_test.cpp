// A board that starts from a saved state: what it sends is what it would have sent, whatever comes in.

#include "base/json.h"
#include "cosim/resume/resumed_node.h"
#include "tests/state/board_runs.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::BoardState;
using cosim::Message;
using cosim::ResumedNode;
using cosim::ResumeOptions;
using cosim::Time;

namespace {

constexpr Time kBoot = 60 * cosim::kMillisecond, kEnd = 90 * cosim::kMillisecond;

/// Runs to kEnd in random grants and holds the node to its EOTs, as the conductor would.
std::vector<Message> run(cosim::Node& node, const std::vector<Message>& inbox, std::uint64_t seed) {
    RandomStream random(seed, "grants");
    std::vector<Message> all;
    auto next = inbox.begin();
    std::vector<Time> earliest(node.ports().size(), 0);
    for (Time now = 0; now < kEnd;) {
        const Time until = std::min(
            kEnd, now + 1 + static_cast<Time>(random.below(random.below(2) ? 100'000'000 : 9'000'000'000)));
        const auto end = std::find_if(next, inbox.end(), [&](const Message& m) { return m.time >= until; });
        std::vector<Message> outbox;
        std::vector<Time> lookaheads;
        for (cosim::PortIndex port = 0; port < node.ports().size(); ++port)
            lookaheads.push_back(node.lookahead(port));
        node.advance(until, {next, end}, outbox);
        const Time first_in = next == end ? cosim::kNever : next->time;
        for (const Message& message : outbox) {
            const Time bound =
                std::min(earliest[message.port], cosim::later(first_in, lookaheads[message.port]));
            REQUIRE(message.time >= bound);
        }
        for (cosim::PortIndex port = 0; port < node.ports().size(); ++port) {
            REQUIRE(node.earliest_output(port) >= until);
            const Time kept = std::min(earliest[port], cosim::later(first_in, lookaheads[port]));
            earliest[port] = std::max(kept, node.earliest_output(port));
        }
        all.insert(all.end(), outbox.begin(), outbox.end());
        next = end;
        now = until;
    }
    std::stable_sort(all.begin(), all.end(), [](const Message& a, const Message& b) {
        return std::pair(a.port, a.time) < std::pair(b.port, b.time);
    });
    return all;
}

std::vector<Message> inputs(std::uint64_t seed, bool pic) {
    RandomStream random(seed, "inputs");
    return random_inputs(random, 0, kEnd, 400, pic ? kPicSignals : kRabSignals);
}

/// The state of a board at kBoot, after `inbox`.
BoardState state_after(const MakeBoard& make, const std::vector<Message>& inbox) {
    std::optional<BoardState> state;
    ResumeOptions options;
    options.save_at = kBoot;
    options.save = [&](BoardState saved) {
        state = std::move(saved);
        return std::string();
    };
    ResumedNode node(make, options);
    run(node, inbox, 5);
    REQUIRE(state);
    CHECK(state->time == kBoot);
    return *state;
}

nlohmann::json report_of(cosim::Node& node) {
    return nlohmann::json::parse(node.finish())["resumed"];
}

struct Board {
    std::string name;
    MakeBoard make;
    bool pic = true;
};

std::vector<Board> boards() {
    std::vector<Board> list{{"own pic", pic_board(own_pic_image()), true},
                            {"own rab", rab_board(own_rab_image()), false}};
    RandomStream random(4, "resumed");
    for (int i = 0; i < 4; ++i)
        list.push_back({"random program", pic_board(random_program(random, false)), true});
    return list;
}

}  // namespace

TEST_CASE("a resumed board sends what it would have sent") {
    for (const Board& board : boards()) {
        INFO(board.name);
        const auto inbox = inputs(1, board.pic);
        const auto plain = board.make();
        const auto expected = run(*plain, inbox, 1);
        const BoardState state = state_after(board.make, inbox);
        for (const bool fall_back : {true, false}) {
            // Lookaheads of a range-and-bearing board between messages are not kept: only from files.
            if (fall_back && !board.pic) continue;
            ResumeOptions options;
            options.from = state;
            options.fall_back = fall_back;
            ResumedNode node(board.make, options);
            const bool same = run(node, inbox, 2) == expected;
            CHECK(same);
            CHECK(report_of(node)["skipped"] == true);
            CHECK(!report_of(node).contains("difference"));
            const auto strip = [](const std::string& text) {
                auto json = nlohmann::json::parse(text);
                json.erase("resumed");
                return json;
            };
            CHECK(strip(node.finish()) == strip(plain->finish()));
        }
    }
}

TEST_CASE("a resumed board lets the message pass that the saved one received") {
    // Who sends it at that very time must be granted beyond: nothing of the board may still come then.
    const Board board = boards().front();
    REQUIRE(board.pic);
    const auto inbox = inputs(1, true);
    ResumeOptions options;
    options.from = state_after(board.make, inbox);
    const std::vector<Message> sent = options.from->sent;
    ResumedNode node(board.make, options);
    int seen = 0;
    std::vector<Message> out;
    for (auto next = inbox.begin(); next != inbox.end() && next->time < kBoot; ++next) {
        const Time at = next->time;
        if (next != inbox.begin() && std::prev(next)->time == at) continue;
        const auto begin =
            seen == 0 ? inbox.begin() : std::find_if(inbox.begin(), next, [&](const Message& m) {
                return m.time >= std::prev(next)->time;
            });
        node.advance(at, {begin, next}, out);
        ++seen;
        for (cosim::PortIndex port = 0; port < node.ports().size(); ++port) {
            const bool sends = std::any_of(sent.begin(), sent.end(), [&](const Message& one) {
                return one.port == port && one.time == at;
            });
            CHECK((node.earliest_output(port) > at) == !sends);
        }
    }
    CHECK(seen > 3);
}

TEST_CASE("a resumed board goes back once it lives by itself") {
    const auto make = rab_board(own_rab_image());
    const BoardState state = state_after(make, {});
    ResumeOptions options;
    options.from = state;
    options.save_at = kBoot + cosim::kMillisecond;
    options.save = [](const BoardState&) { return std::string(); };
    ResumedNode node(make, options);
    std::vector<Message> outbox;
    node.advance(kBoot / 2, {}, outbox);
    CHECK(node.rewindable() == nullptr);
    node.advance(kBoot, {}, outbox);
    CHECK(node.rewindable() == nullptr);  // its own state is still to be saved
    node.advance(options.save_at, {}, outbox);
    REQUIRE(node.rewindable() != nullptr);
    outbox.clear();
    std::vector<Message> again;
    node.rewindable()->mark();
    node.advance(kEnd, {}, outbox);
    node.rewindable()->rewind();
    node.advance(kEnd, {}, again);
    CHECK(again == outbox);
}

TEST_CASE("a resumed board that receives something else executes it") {
    const auto list = boards();
    for (int i = 0; i < 60; ++i) {
        const Board& board = list[static_cast<std::size_t>(i) % list.size()];
        if (!board.pic) continue;
        INFO(board.name << ", case " << i);
        RandomStream random(static_cast<std::uint64_t>(i), "differences");
        const auto inbox = inputs(100 + random.below(5), true);
        const BoardState state = state_after(board.make, inbox);
        // One message more, fewer or other, before kBoot.
        auto other = inbox;
        const auto before_boot =
            std::count_if(inbox.begin(), inbox.end(), [](const Message& m) { return m.time < kBoot; });
        const auto place = static_cast<std::ptrdiff_t>(random.below(static_cast<std::uint64_t>(before_boot)));
        const Time at = other[static_cast<std::size_t>(place)].time;
        switch (random.below(3)) {
        case 0:
            other.erase(other.begin() + place);
            break;
        case 1:
            other[static_cast<std::size_t>(place)] = {at, 3, cosim::Signal{0, 1234.5}};
            break;
        default:
            other.insert(other.begin() + place, {at, 3, cosim::Signal{1, 99}});
        }
        const auto plain = board.make();
        const auto expected = run(*plain, other, 3);
        ResumeOptions options;
        options.from = state;
        options.save_at = kBoot;
        std::optional<BoardState> again;
        options.save = [&](BoardState saved) {
            again = std::move(saved);
            return std::string();
        };
        ResumedNode node(board.make, options);
        const bool same = run(node, other, 4) == expected;
        REQUIRE(same);
        CHECK(report_of(node)["skipped"] == false);
        const std::string difference = report_of(node)["difference"];
        CHECK(difference.find("at " + std::to_string(cosim::to_seconds(at)).substr(0, 7)) !=
              std::string::npos);
        // What it saves instead is of this life.
        REQUIRE(again);
        ResumeOptions second;
        second.from = again;
        ResumedNode resumed(board.make, second);
        const bool same_again = run(resumed, other, 6) == expected;
        CHECK(same_again);
        CHECK(report_of(resumed)["skipped"] == true);
    }
}

TEST_CASE("a state that the user gave is kept, and where it differs is reported") {
    const MakeBoard make = pic_board(own_pic_image());
    const auto inbox = inputs(1, true);
    const BoardState state = state_after(make, inbox);
    ResumeOptions options;
    options.from = state;
    options.fall_back = false;
    ResumedNode node(make, options);
    std::vector<Message> outbox;
    node.advance(kBoot, {}, outbox);
    std::vector<Message> sent = outbox;
    std::stable_sort(sent.begin(), sent.end(), [](auto& a, auto& b) { return a.time < b.time; });
    const bool same = sent == state.sent;
    CHECK(same);
    const auto report = nlohmann::json::parse(node.finish());
    CHECK(report["resumed"]["skipped"] == true);
    const std::string warning = report["warnings"][0];
    CHECK(
        warning.find("did not live through the first 0.060 s of this run: it did not receive what the saved "
                     "board received on port ") == 0);
}

TEST_CASE("a run that ends before the state begins reports what the board did by then") {
    const MakeBoard make = pic_board(own_pic_image());
    const auto inbox = inputs(1, true);
    ResumeOptions options;
    options.from = state_after(make, inbox);
    ResumedNode node(make, options);
    const auto plain = make();
    std::vector<Message> first(inbox.begin(), std::find_if(inbox.begin(), inbox.end(), [](const Message& m) {
                                   return m.time >= kBoot / 2;
                               }));
    std::vector<Message> a, b;
    node.advance(kBoot / 2, first, a);
    plain->advance(kBoot / 2, first, b);
    auto report = nlohmann::json::parse(node.finish());
    CHECK(report["resumed"]["skipped"] == false);
    report.erase("resumed");
    CHECK(report == nlohmann::json::parse(plain->finish()));
}
