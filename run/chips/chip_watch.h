#pragma once
// What a scenario expects to read of a board's chip some time (run/expectations).

#include "base/fields/field.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <string>

namespace puckloop::tools {

struct ChipWatch {
    std::string file{};                 ///< of the expectation, for errors
    std::string place{};                ///< there: "line 12"
    std::string what{};                 ///< "TRISD == 16" (run/chips/value_words.h)
    cosim::Time after = 0;              ///< the first look
    cosim::Time by = cosim::kNever;     ///< no look is later
    cosim::Time every = cosim::kNever;  ///< from one look to the next

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("file", &ChipWatch::file, "of the expectation"), field("place", &ChipWatch::place, "there"),
            field("what", &ChipWatch::what, "a value of the chip and what it is compared with").required(),
            field("after_ps", &ChipWatch::after, "the first look").in("ps"),
            field("by_ps", &ChipWatch::by, "no look is later").in("ps"),
            field("every_ps", &ChipWatch::every, "from one look to the next").in("ps"));
    }
};
static_assert(lists_all_fields<ChipWatch>);

}  // namespace puckloop::tools
