#pragma once
// What a run does with a board beside running it: where its state comes from and goes, who looks at it.

#include "base/fields/field.h"
#include "cosim/core/time.h"
#include "run/chips/chip_watch.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Where a board's state comes from.
struct FromState {
    std::string path;
    bool cache = false;
    std::string board{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("path", &FromState::path, "the state file").required(),
            field("cache", &FromState::cache, "it is the user's cache: one that cannot be used is not there"),
            field("board", &FromState::board, "whose state in that file, unless it is the cache"));
    }
};
static_assert(lists_all_fields<FromState>);

/// Where and when a board's state is kept.
struct SaveState {
    std::string path;
    cosim::Time at = 0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("path", &SaveState::path, "file to write").required(),
                     field("at_ps", &SaveState::at, "instant").in("ps").required());
    }
};
static_assert(lists_all_fields<SaveState>);

struct BoardCare {
    std::optional<FromState> from_state{};
    std::optional<SaveState> save_state{};
    std::string gdb{};
    bool stats = false;
    std::vector<ChipWatch> watches{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("from_state", &BoardCare::from_state, "what the board begins with; none: power-up"),
            field("save_state", &BoardCare::save_state, "where its state goes; none: nowhere"),
            field("gdb", &BoardCare::gdb, "place of its debugger; empty: none"),
            field("stats", &BoardCare::stats, "the chip is profiled"),
            field("watches", &BoardCare::watches, "values of the chip that are expected"));
    }
};
static_assert(lists_all_fields<BoardCare>);

}  // namespace puckloop::tools
