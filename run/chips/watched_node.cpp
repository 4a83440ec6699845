#include "run/chips/watched_node.h"

#include "base/error.h"
#include "base/json.h"
#include "run/chips/board_around.h"
#include "run/chips/board_chip.h"
#include "run/chips/chip_values.h"
#include "run/chips/value_words.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace puckloop::tools {

namespace {

using cosim::Time;
using nlohmann::json;
using nlohmann::ordered_json;

/// One watch, and what has been seen of it.
struct Look {
    json comparison;
    Time next = 0, by = cosim::kNever, every = 0;
    std::optional<Time> seen{};
    std::uint64_t last = 0;  ///< what was read last
    Time last_at = -1;       ///< when; before 0: never

    Time due() const { return seen || next > by ? cosim::kNever : next; }
};

class WatchedNode final : public BoardAround, private cosim::Rewindable {
  public:
    WatchedNode(std::unique_ptr<cosim::StatefulNode> board, const std::string& firmware,
                const std::vector<ChipWatch>& watches)
        : BoardAround(std::move(board)),
          chip_(chip_of(this->board()).chip),
          values_(*chip_, std::string(name()), firmware) {
        for (const ChipWatch& watch : watches)
            looks_.push_back(look_of(watch));
    }

    void advance(Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Rewindable* rewindable() override { return board().rewindable() == nullptr ? nullptr : this; }
    void state(StateWriter& archive) const override;
    void state(StateReader& archive) override;
    std::string finish() override;

  private:
    Look look_of(const ChipWatch& watch) const;
    void look(Time now);
    void mark() override {
        marked_ = looks_;
        board().rewindable()->mark();
    }
    void rewind() override {
        looks_ = marked_;
        board().rewindable()->rewind();
    }
    void settle() override { board().rewindable()->settle(); }

    std::unique_ptr<debug::DebugChip> chip_;
    ChipValues values_;
    std::vector<Look> looks_, marked_;
};

Look WatchedNode::look_of(const ChipWatch& watch) const {
    try {
        std::optional<json> comparison = comparison_of_words(watch.what);
        if (!comparison || comparison->contains("node"))
            throw InputError(
                "", "holds", "'" + watch.what + "' compares nothing",
                "a place, a sign and a number: TMR1 >= 9, U2STA.TRMT == 1, counter != 0, 0x850:4 == 7");
        if (!values_.read(*comparison).contains("value"))
            throw InputError("", "holds", "more than 8 bytes are no number");
        return {std::move(*comparison), watch.after, watch.by, watch.every};
    } catch (const InputError& error) {
        throw InputError(watch.file, watch.place, std::string("expect: ") + error.what());
    }
}

/// The board is where each instruction that begins before `now` was executed, whatever was granted before.
void WatchedNode::look(Time now) {
    for (Look& one : looks_) {
        if (one.due() != now) continue;
        one.last = values_.read(one.comparison).at("value").get<std::uint64_t>();
        one.last_at = now;
        if (comparison_holds(one.last, one.comparison.at("is").get<std::string>(),
                             one.comparison.at("value").get<std::uint64_t>()))
            one.seen = now;
        one.next = one.every < one.by - now ? now + one.every : now < one.by ? one.by : cosim::kNever;
    }
}

void WatchedNode::advance(Time until, std::span<const cosim::Message> inbox,
                          std::vector<cosim::Message>& outbox) {
    for (;;) {
        Time due = cosim::kNever;
        for (const Look& one : looks_)
            due = std::min(due, one.due());
        if (due > until) break;
        advance_part(due, inbox, outbox);
        look(due);
    }
    BoardAround::advance(until, inbox, outbox);
}

void WatchedNode::state(StateWriter& archive) const {
    BoardAround::state(archive);
    for (const Look& one : looks_)
        archive(one.next, one.seen, one.last, one.last_at);
}

void WatchedNode::state(StateReader& archive) {
    BoardAround::state(archive);
    for (Look& one : looks_)
        archive(one.next, one.seen, one.last, one.last_at);
}

std::string WatchedNode::finish() {
    ordered_json report = ordered_json::parse(BoardAround::finish());
    ordered_json& watches = report["watches"] = ordered_json::array();
    for (const Look& one : looks_) {
        ordered_json entry = ordered_json::object();
        if (one.seen) entry["seen_s"] = cosim::to_seconds(*one.seen);
        if (one.last_at >= 0) {
            entry["last"] = one.last;
            entry["last_s"] = cosim::to_seconds(one.last_at);
        }
        watches.push_back(std::move(entry));
    }
    return report.dump();
}

}  // namespace

std::unique_ptr<cosim::StatefulNode> make_watched(std::unique_ptr<cosim::StatefulNode> board,
                                                  const std::string& firmware,
                                                  const std::vector<ChipWatch>& watches) {
    return std::make_unique<WatchedNode>(std::move(board), firmware, watches);
}

}  // namespace puckloop::tools
