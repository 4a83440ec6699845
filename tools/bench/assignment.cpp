#include "tools/bench/assignment.h"

#include "base/error.h"
#include "base/text/csv.h"

#include <fmt/format.h>

namespace puckloop::tools {

std::map<std::string, double> assignments_of(const std::vector<std::string>& texts) {
    std::map<std::string, double> values;
    for (const std::string& text : texts) {
        const auto equals = text.find('=');
        double value = 0.0;
        if (equals == std::string::npos || equals == 0 ||
            !csv_number(std::string_view(text).substr(equals + 1), value))
            throw InputError("", "--set", fmt::format("'{}' is not an assignment", text), "NAME=NUMBER");
        values[text.substr(0, equals)] = value;
    }
    return values;
}

}  // namespace puckloop::tools
