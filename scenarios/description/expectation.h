#pragma once
// What a scenario expects of its run: one [[expect]] table each, judged at the end.

#include "missions/mission.h"

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace puckloop::scenarios {

struct Expectation {
    enum class Kind {
        Log,      ///< a line of a node's log has a text
        Line,     ///< bytes go over a serial line, one after the other in one direction
        Place,    ///< a robot is in a region
        NoReset,  ///< a board starts once
        Value,    ///< a value of a board's chip compares as stated
        Frame,    ///< frames of a protocol are on the lines
        NoLoss    ///< a serial line loses nothing
    };
    /// Of a decoded frame's field.
    using FieldValue = std::variant<bool, std::int64_t, double, std::string>;
    Kind kind = Kind::Log;
    std::string name;     ///< for people: the table's, or made from its keys
    std::string stated;   ///< what the keys say, where the table has a name of its own
    std::string place;    ///< of the table: "line 12"
    std::string subject;  ///< node, link or robot; Frame: the protocol
    std::string from{};   ///< Line, Frame: node that sends; empty: any
    std::string text{};   ///< Log, Frame: in a line; Line: the bytes; Value: "TRISD == 16"
    std::vector<std::pair<std::string, FieldValue>> has{};  ///< Frame: fields that it has
    std::int64_t at_least = 1;                              ///< Frame: so many
    missions::Region region{};
    double after = 0.0;                                   ///< s; not of Log, NoReset and NoLoss
    double by = std::numeric_limits<double>::infinity();  ///< s
    double every = 1e-3;                                  ///< s, Value: from one look to the next
    bool seen = true;                                     ///< false: it must not happen
};

}  // namespace puckloop::scenarios
