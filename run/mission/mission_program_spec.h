#pragma once
// A mission program of a run: it gets what the tracker sees, counts the score, and may act on the world.

#include "base/fields/field.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

struct MissionProgramSpec {
    static constexpr double kTimeout = 10.0;  // s

    std::vector<std::string> command{};
    std::string better = "more";
    double timeout = kTimeout;
    std::string log{};
    std::optional<double> duration{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("command", &MissionProgramSpec::command, "the program's path and its arguments").required(),
            field("better", &MissionProgramSpec::better, "\"more\" or \"less\" of the score is better"),
            field("timeout", &MissionProgramSpec::timeout, "wall time that an answer may take")
                .in("s")
                .above(0)
                .not_in(Comparison::Run),
            field("log", &MissionProgramSpec::log, "file for its standard error; empty: puckloop's own")
                .not_in(Comparison::Run),
            field("duration", &MissionProgramSpec::duration, "of the run, if it is known").in("s"));
    }
};
static_assert(lists_all_fields<MissionProgramSpec>);

}  // namespace puckloop::tools
