#include "tools/guide/schema/schema_kit.h"

#include <fmt/format.h>

#include <utility>

namespace puckloop::tools {

using nlohmann::ordered_json;

namespace {

/// A number with one of these units, as scenarios/values/quantity.cpp takes it.
ordered_json quantity(const char* units) {
    return {
        {"type", "string"},
        {"pattern", fmt::format("^ *[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)? *({}) *$", units)}};
}

constexpr const char* kTime = "s|ms|us|min|h";
constexpr const char* kLength = "m|cm|mm";

ordered_json list_of(ordered_json item, int count) {
    return {{"type", "array"}, {"items", std::move(item)}, {"minItems", count}, {"maxItems", count}};
}

ordered_json plain(std::string_view type) {
    if (type == "time") return quantity(kTime);
    if (type == "length") return quantity(kLength);
    if (type == "angle") return quantity("rad|deg");
    if (type == "mass") return quantity("kg|g");
    if (type == "frequency") return quantity("Hz|kHz|MHz");
    if (type == "voltage") return quantity("V|mV");
    if (type == "gain") return quantity("dB");
    if (type == "level") return quantity("dBm");
    if (type == "rate") return quantity("bit/s|kbit/s|Mbit/s|Gbit/s");
    if (type == "ratio") return {{"anyOf", {{{"type", "number"}}, quantity("%|ppm|")}}};
    if (type == "number") return {{"anyOf", {{{"type", "number"}}, quantity("")}}};
    if (type == "integer") return {{"type", "integer"}};
    if (type == "text") return {{"type", "string"}};
    if (type == "texts")
        return {{"anyOf", {{{"type", "string"}}, {{"type", "array"}, {"items", {{"type", "string"}}}}}}};
    if (type == "flag") return {{"type", "boolean"}};
    if (type == "table") return {{"type", "object"}};
    if (type == "lengths2") return list_of(quantity(kLength), 2);
    if (type == "lengths3") return list_of(quantity(kLength), 3);
    if (type == "times2") return list_of(quantity(kTime), 2);
    return ordered_json::object();
}

}  // namespace

ordered_json value_schema(std::string_view type, std::string_view about) {
    ordered_json schema = plain(type);
    if (!about.empty()) schema["description"] = about;
    return schema;
}

ordered_json table_schema(std::string_view about, std::span<const SchemaKey> keys,
                          std::initializer_list<std::string_view> required) {
    ordered_json table{{"type", "object"}, {"description", about}, {"additionalProperties", false}};
    table["properties"] = ordered_json::object();
    add_keys(table, keys);
    if (required.size() > 0) {
        table["required"] = ordered_json::array();
        for (const std::string_view key : required)
            table["required"].push_back(key);
    }
    return table;
}

ordered_json list_schema(ordered_json table) {
    return {{"type", "array"}, {"items", std::move(table)}};
}

void add_keys(ordered_json& table, std::span<const SchemaKey> keys) {
    for (const SchemaKey& key : keys)
        table["properties"][std::string(key.name)] = value_schema(key.type, key.about);
}

ordered_json schema_head(std::string_view name, std::string_view title) {
    return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
            {"$id", fmt::format("urn:puckloop:schema:{}:1", name)},
            {"title", title}};
}

}  // namespace puckloop::tools
