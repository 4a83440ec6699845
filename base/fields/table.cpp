#include "base/fields/table.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop {

namespace detail {

std::string range_text(double least, double most, bool open) {
    const std::string from = open ? fmt::format("above {:g}", least) : fmt::format("{:g}", least);
    if (std::isinf(least) && std::isinf(most)) return {};
    if (std::isinf(least)) return fmt::format("up to {:g}", most);
    if (std::isinf(most)) return open ? from : from + " or more";
    return fmt::format("{} to {:g}", from, most);
}

std::string default_text(const JsonValue& value) {
    if (value.text() != nullptr && value.text()->empty()) return "none";
    if (value.is_number()) return fmt::format("{:g}", value.number());
    return dump(value);
}

JsonValue with_range(JsonValue schema, double least, double most, bool open) {
    if (std::isinf(least) && std::isinf(most)) return schema;
    // Of a list each number is meant.
    JsonValue* items = schema.find("items");
    JsonValue& numbers = items != nullptr ? *items : schema;
    if (!std::isinf(least)) numbers.set(open ? "exclusiveMinimum" : "minimum", least);
    if (!std::isinf(most)) numbers.set("maximum", most);
    return schema;
}

}  // namespace detail

std::string markdown_table(const std::vector<FieldRow>& rows) {
    std::string text = "| key | type | unit | range | default | meaning |\n|---|---|---|---|---|---|\n";
    for (const FieldRow& row : rows)
        text += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", row.key, row.type, row.unit, row.range,
                            row.standard, row.about);
    return text;
}

}  // namespace puckloop
