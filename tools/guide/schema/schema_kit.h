#pragma once
// Short hands for schemas of TOML tables.

#include "base/json.h"

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace puckloop::tools {

/// What a key holds: "time", "length", "angle", "mass", "frequency", "voltage", "ratio", "number", "integer",
/// "text", "texts" (one or a list), "flag", "lengths2", "lengths3", "times2", "any".
struct SchemaKey {
    std::string_view name;
    std::string_view type;
    std::string_view about;
};

nlohmann::ordered_json value_schema(std::string_view type, std::string_view about);

/// A table with these keys and no others.
nlohmann::ordered_json table_schema(std::string_view about, std::span<const SchemaKey> keys,
                                    std::initializer_list<std::string_view> required = {});

/// [[name]] tables.
nlohmann::ordered_json list_schema(nlohmann::ordered_json table);

/// Adds keys to a table's.
void add_keys(nlohmann::ordered_json& table, std::span<const SchemaKey> keys);

nlohmann::ordered_json schema_head(std::string_view name, std::string_view title);

}  // namespace puckloop::tools
