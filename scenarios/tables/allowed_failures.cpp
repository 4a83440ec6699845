#include "scenarios/tables/allowed_failures.h"

#include "base/text/suggest.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace puckloop::scenarios {

std::vector<std::string> read_allowed(Reader& run) {
    const std::vector<std::string_view> kinds{"program", "silent_line", "hung"};
    std::vector<std::string> allowed = run.texts("allow");
    for (const std::string& kind : allowed)
        if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
            run.fail("allow", fmt::format("allow: no failure is called '{}'", kind),
                     fmt::format("of {}{}", fmt::join(kinds, ", "), did_you_mean(kind, kinds)));
    return allowed;
}

}  // namespace puckloop::scenarios
