#pragma once
// What the nodes of a main board and of a range-and-bearing board save alike, and how they go back.

#include "base/states/archive.h"
#include "base/states/checkpoint.h"
#include "cosim/core/node.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <memory>

namespace puckloop::board {

/// `own` is the node's own part.
template <class Archive, class Own, class Board, class Chip, class Log>
void save_node(Archive& archive, const cosim::Time& granted, const Own& own, const Board& board,
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

/// Goes back by a checkpoint of all that `Node` lists for a CheckpointWriter and a CheckpointReader; `Chip`
/// is whatever holds the chip.
template <class Node, class Chip, class Log>
class NodeMark : public cosim::Rewindable {
  public:
    /// `chip` is made later, and stays.
    NodeMark(Node& node, const std::unique_ptr<Chip>& chip, Log& log) : node_(node), chip_(chip), log_(log) {}

    void mark() override {
        log_.mark();
        chip_->mark();
        checkpoint_.take(node_);
        bytes_ += checkpoint_.size();
    }
    void rewind() override {
        log_.rewind();
        chip_->rewind();
        checkpoint_.restore(node_);
        bytes_ += checkpoint_.size();
    }
    void settle() override {
        chip_->settle();
        log_.settle();
    }
    /// Copied into and out of the checkpoint so far.
    std::uint64_t bytes() const { return bytes_; }

  private:
    Node& node_;
    const std::unique_ptr<Chip>& chip_;
    Log& log_;
    Checkpoint checkpoint_;
    std::uint64_t bytes_ = 0;
};

}  // namespace puckloop::board
