#pragma once
// What the nodes of a main board and of a range-and-bearing board save alike.

#include "base/archive.h"
#include "cosim/core/time.h"

namespace puckloop::board {

/// `own` is the node's own part.
template <class Own, class Board, class Chip, class Log>
void save_node(StateWriter& archive, const cosim::Time& granted, const Own& own, const Board& board,
               const Chip& chip, const Log& log) {
    archive(granted, own);
    archive.part("board", board);
    archive.part("chip", chip);
    archive.part("log", log);
}

template <class Own, class Board, class Chip, class Log>
void load_node(StateReader& archive, cosim::Time& granted, Own& own, Board& board, Chip& chip, Log& log) {
    archive.bounded(granted, 0, cosim::kNever);
    archive(own);
    archive.part("board", board);
    archive.part("chip", chip);
    archive.part("log", log);
    archive.check(chip.now() == granted, "node and chip at different times");
    log.loaded(granted);
}

}  // namespace puckloop::board
