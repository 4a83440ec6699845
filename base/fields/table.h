#pragma once
// A struct's fields (field.h) as rows of a table for readers, and as a JSON Schema for programs.

#include "base/fields/json.h"

#include <string>
#include <string_view>
#include <vector>

namespace puckloop {

struct FieldRow {
    std::string key, type, unit, range, standard, about;  ///< `standard`: the default; "required": none
};

namespace detail {

std::string range_text(double least, double most, bool open);
std::string default_text(const JsonValue& value);
JsonValue with_range(JsonValue schema, double least, double most, bool open);

}  // namespace detail

template <class T>
JsonValue schema_of();

namespace detail {

template <class M>
JsonValue schema_of_member() {
    JsonValue schema;
    const auto type = [&](const char* name) { schema.set("type", name); };
    if constexpr (Described<M>) {
        return schema_of<M>();
    } else if constexpr (IsOptional<M>::value) {
        return schema_of_member<typename M::value_type>();
    } else if constexpr (std::is_same_v<M, bool>) {
        type("boolean");
    } else if constexpr (std::is_integral_v<M>) {
        type("integer");
    } else if constexpr (std::is_floating_point_v<M>) {
        type("number");
    } else if constexpr (std::is_constructible_v<std::string, M>) {
        type("string");
    } else if constexpr (Map<M>) {
        type("object");
        schema.set("additionalProperties", schema_of_member<typename M::mapped_type>());
    } else if constexpr (std::ranges::range<M>) {
        type("array");
        schema.set("items", schema_of_member<typename M::value_type>());
    }
    return schema;  // of a form of its own: anything
}

template <class T>
void add_properties(const T& standard, JsonValue& properties, JsonValue& required) {
    for_each_entry<T>([&]<class Entry>(const Entry& entry) {
        using M = typename MemberOf<Entry>::type;
        if constexpr (requires { entry.key; }) {
            JsonValue schema = JsonValue::Object{};
            if constexpr (std::is_same_v<Entry, Field<T, M>>) schema = schema_of_member<M>();
            std::string about(entry.about);
            if (!entry.unit.empty()) about += " (" + std::string(entry.unit) + ")";
            schema.set("description", about);
            schema = with_range(std::move(schema), entry.least, entry.most, entry.open);
            JsonValue all = JsonValue::Object{};
            write_fields(standard, all);
            if (entry.needed)
                required.push(std::string(entry.key));
            else if (const JsonValue* value = all.find(entry.key))
                schema.set("default", *value);
            properties.set(entry.key, std::move(schema));
        } else if constexpr (std::is_same_v<Entry, Part<T, M>>) {
            add_properties(standard.*entry.member, properties, required);
        }
    });
}

template <class T>
void add_rows(const T& standard, std::vector<FieldRow>& rows) {
    for_each_entry<T>([&]<class Entry>(const Entry& entry) {
        using M = typename MemberOf<Entry>::type;
        if constexpr (requires { entry.key; }) {
            FieldRow row;
            row.key = entry.key;
            if constexpr (std::is_same_v<Entry, Field<T, M>>) {
                const JsonValue schema = schema_of_member<M>();
                if (const JsonValue* type = schema.find("type")) row.type = *type->text();
            }
            row.unit = entry.unit;
            row.range = range_text(entry.least, entry.most, entry.open);
            row.about = entry.about;
            JsonValue all = JsonValue::Object{};
            write_fields(standard, all);
            const JsonValue* value = all.find(entry.key);
            row.standard = entry.needed ? "required" : value ? default_text(*value) : "none";
            rows.push_back(std::move(row));
        } else if constexpr (std::is_same_v<Entry, Part<T, M>>) {
            add_rows(standard.*entry.member, rows);
        }
    });
}

}  // namespace detail

/// One row per field, in the order of the list.
template <Described T>
std::vector<FieldRow> rows_of() {
    std::vector<FieldRow> rows;
    detail::add_rows(T{}, rows);
    return rows;
}

/// A table in Markdown.
std::string markdown_table(const std::vector<FieldRow>& rows);

/// JSON Schema (draft 2020-12) of what from_value() takes for a T.
template <class T>
JsonValue schema_of() {
    JsonValue schema, properties = JsonValue::Object{}, required;
    schema.set("type", "object");
    detail::add_properties(T{}, properties, required);
    schema.set("properties", std::move(properties));
    if (!required.is_null()) schema.set("required", std::move(required));
    schema.set("additionalProperties", false);
    return schema;
}

}  // namespace puckloop
