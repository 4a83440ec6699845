#include "base/fields/json_value.h"

#include "base/json.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace puckloop {

namespace {

using nlohmann::ordered_json;

JsonValue value_of(const ordered_json& json) {
    switch (json.type()) {
    case ordered_json::value_t::boolean:
        return json.get<bool>();
    case ordered_json::value_t::number_integer:
        return json.get<std::int64_t>();
    case ordered_json::value_t::number_unsigned:
        return json.get<std::uint64_t>();
    case ordered_json::value_t::number_float:
        return json.get<double>();
    case ordered_json::value_t::string:
        return json.get<std::string>();
    case ordered_json::value_t::array: {
        JsonValue::Array list;
        list.reserve(json.size());
        for (const ordered_json& one : json)
            list.push_back(value_of(one));
        return list;
    }
    case ordered_json::value_t::object: {
        JsonValue::Object object;
        object.reserve(json.size());
        for (const auto& [key, one] : json.items())
            object.push_back({key, value_of(one)});
        return object;
    }
    default:
        return {};
    }
}

struct ToLibrary {
    ordered_json operator()(const JsonValue::Array& list) const {
        ordered_json json = ordered_json::array();
        for (const JsonValue& one : list)
            json.push_back(visit(one));
        return json;
    }
    ordered_json operator()(const JsonValue::Object& object) const {
        ordered_json::object_t json;
        json.reserve(object.size());
        for (const JsonMember& member : object)
            static_cast<std::vector<std::pair<const std::string, ordered_json>>&>(json).emplace_back(
                member.key, visit(member.value));
        return json;
    }
    ordered_json operator()(const auto& plain) const { return plain; }

    ordered_json visit(const JsonValue& value) const {
        if (const auto* list = value.array()) return (*this)(*list);
        if (const auto* object = value.object()) return (*this)(*object);
        if (const auto* text = value.text()) return *text;
        if (const auto* flag = value.boolean()) return *flag;
        if (value.fits_uint64()) return value.uint64();
        if (value.fits_int64()) return value.int64();
        if (value.is_number()) return value.number();
        return nullptr;
    }
};

constexpr auto kMostInt64 = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());

}  // namespace

double JsonValue::number() const {
    if (const auto* real = std::get_if<double>(&value_)) return *real;
    if (const auto* negative = std::get_if<std::int64_t>(&value_)) return static_cast<double>(*negative);
    return static_cast<double>(std::get<std::uint64_t>(value_));
}

bool JsonValue::fits_uint64() const {
    return std::holds_alternative<std::uint64_t>(value_);
}

bool JsonValue::fits_int64() const {
    const auto* positive = std::get_if<std::uint64_t>(&value_);
    return positive ? *positive <= kMostInt64 : std::holds_alternative<std::int64_t>(value_);
}

std::uint64_t JsonValue::uint64() const {
    return std::get<std::uint64_t>(value_);
}

std::int64_t JsonValue::int64() const {
    const auto* positive = std::get_if<std::uint64_t>(&value_);
    return positive ? static_cast<std::int64_t>(*positive) : std::get<std::int64_t>(value_);
}

void JsonValue::set(std::string_view key, JsonValue value) {
    if (is_null()) value_ = Object{};
    if (JsonValue* there = find(key))
        *there = std::move(value);
    else
        object()->push_back({std::string(key), std::move(value)});
}

void JsonValue::push(JsonValue value) {
    if (is_null()) value_ = Array{};
    array()->push_back(std::move(value));
}

const JsonValue* JsonValue::find(std::string_view key) const {
    if (const Object* members = object())
        for (const JsonMember& member : *members)
            if (member.key == key) return &member.value;
    return nullptr;
}

JsonValue* JsonValue::find(std::string_view key) {
    return const_cast<JsonValue*>(std::as_const(*this).find(key));
}

void JsonValue::erase(std::string_view key) {
    if (Object* members = object())
        std::erase_if(*members, [&](const JsonMember& member) { return member.key == key; });
}

bool operator==(const JsonValue& a, const JsonValue& b) {
    return a.value_ == b.value_;
}

JsonValue parse_json(std::string_view text) {
    try {
        return value_of(ordered_json::parse(text));
    } catch (const ordered_json::exception& error) {
        throw std::invalid_argument(error.what());
    }
}

std::string dump(const JsonValue& value, int indent) {
    return ToLibrary{}.visit(value).dump(indent);
}

}  // namespace puckloop
