#pragma once
// What a scenario expects of its run: one [[expect]] table each, judged at the end.

#include "missions/mission.h"

#include <limits>
#include <string>

namespace puckloop::scenarios {

struct Expectation {
    enum class Kind {
        Log,     ///< a line of a node's log has a text
        Line,    ///< bytes go over a serial line, one after the other in one direction
        Place,   ///< a robot is in a region
        NoReset  ///< a board starts once
    };
    Kind kind = Kind::Log;
    std::string name;     ///< for people: the table's, or made from its keys
    std::string place;    ///< of the table: "line 12"
    std::string subject;  ///< node, link or robot
    std::string from{};   ///< Line: node that sends; empty: either
    std::string text{};   ///< Log: the text; Line: the bytes
    missions::Region region{};
    double after = 0.0;                                   ///< s, Line and Place
    double by = std::numeric_limits<double>::infinity();  ///< s
    bool seen = true;                                     ///< false: it must not happen
};

}  // namespace puckloop::scenarios
