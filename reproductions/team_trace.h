#pragma once
// What a run of a team leaves in its trace: each message that a robot's main board sent to all over UART2, as
// firmware/network does ("9999 hello 00012" and CR), and when it was where on its way to each of the others.

#include "cosim/trace/trace_row.h"

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::tools {

/// Times in s of the run; negative: not seen.
struct Arrival {
    double passed = -1;    ///< the manager handed it to the network
    double arrived = -1;   ///< at the receiver's Linux board
    double received = -1;  ///< its CR at the receiver's main board
};

struct TeamMessage {
    std::size_t from = 0;
    std::string data;
    double begun = 0;               ///< its first bit left the main board
    double ended = 0;               ///< its CR is at the Linux board
    std::vector<Arrival> arrivals;  ///< of each robot, the sender's unused
};

/// Puts rows of a trace together to messages. Robots are robot0, robot1, ...; robot i has number i + 1.
class TeamTrace {
  public:
    /// `manager`: the host that passes messages on.
    TeamTrace(std::size_t robots, std::string manager);

    /// In the order of the trace.
    void add(const cosim::TraceRow& row);
    /// In the order in which they ended.
    const std::vector<TeamMessage>& messages() const { return messages_; }

  private:
    struct Line {
        std::string text;
        double begun = 0;
    };
    void from_board(std::size_t robot, char character, const cosim::TraceRow& row);
    void to_board(std::size_t robot, char character, const cosim::TraceRow& row);
    void packet(const cosim::Packet& packet, const cosim::TraceRow& row);
    /// That robot `from` (by its number) sent; null: none.
    TeamMessage* find(std::string_view line);

    std::string manager_;
    std::map<std::string, std::size_t> boards_, computers_;  ///< robots by name of node
    std::vector<Line> up_, down_;                            ///< of each robot
    std::vector<TeamMessage> messages_;
    std::map<std::pair<std::size_t, std::string>, std::size_t> known_;  ///< messages by sender and data
};

}  // namespace puckloop::tools
