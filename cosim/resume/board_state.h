#pragma once
// A board as it was at one instant of a run, with all that it received and sent until then.

#include "cosim/core/message_state.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// What a state belongs to. All but `node` and `parameters` must be the same for a board that takes it over.
struct BoardIdentity {
    std::string node;        ///< "robot0.pic"
    std::string kind;        ///< "e-puck main board", ...
    std::string chip;        ///< "dsPIC30F6014A"
    std::string image;       ///< SHA-256 of the firmware's file, hexadecimal
    std::string parameters;  ///< everything else that decides how it runs

    template <class Archive>
    void state(Archive& archive) {
        archive(node, kind, chip, image, parameters);
    }
    friend bool operator==(const BoardIdentity&, const BoardIdentity&) = default;
};

struct BoardState {
    BoardIdentity board;
    Time time = 0;                     ///< nothing of this instant has happened yet
    std::vector<Message> received;     ///< before `time`, in order
    std::vector<Message> sent;         ///< by then, by time
    std::vector<std::uint8_t> memory;  ///< the node's own state (cosim/core/stateful_node.h)

    template <class Archive>
    void state(Archive& archive) {
        archive(board);
        archive.bounded(time, 0, kNever);
        archive(received, sent, memory);
    }
};

}  // namespace puckloop::cosim
