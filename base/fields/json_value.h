#pragma once
// A JSON value without the library that reads and writes the text, which stays in json_value.cpp.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace puckloop {

struct JsonMember;

class JsonValue {
  public:
    using Array = std::vector<JsonValue>;
    using Object = std::vector<JsonMember>;  ///< in the order in which keys were set

    JsonValue() = default;  ///< null
    template <class T>
    requires std::is_arithmetic_v<T> JsonValue(T number) {
        if constexpr (std::is_same_v<T, bool> || std::is_floating_point_v<T>)
            value_ = number;
        else if (std::is_signed_v<T> && number < 0)
            value_ = static_cast<std::int64_t>(number);
        else  // so that equal numbers have equal forms
            value_ = static_cast<std::uint64_t>(number);
    }
    JsonValue(std::string text) : value_(std::move(text)) {}
    JsonValue(const char* text) : value_(std::string(text)) {}
    JsonValue(Array list) : value_(std::move(list)) {}
    JsonValue(Object object) : value_(std::move(object)) {}

    bool is_null() const { return std::holds_alternative<std::nullptr_t>(value_); }
    /// Null: the value has another type. An integer is a number, too.
    const bool* boolean() const { return std::get_if<bool>(&value_); }
    const std::string* text() const { return std::get_if<std::string>(&value_); }
    const Array* array() const { return std::get_if<Array>(&value_); }
    const Object* object() const { return std::get_if<Object>(&value_); }
    Array* array() { return std::get_if<Array>(&value_); }
    Object* object() { return std::get_if<Object>(&value_); }
    std::string* text() { return std::get_if<std::string>(&value_); }
    bool is_number() const { return is_integer() || std::holds_alternative<double>(value_); }
    bool is_integer() const {
        return std::holds_alternative<std::int64_t>(value_) || std::holds_alternative<std::uint64_t>(value_);
    }
    double number() const;         ///< of a number
    bool fits_int64() const;       ///< an integer within its range
    bool fits_uint64() const;      ///< likewise
    std::int64_t int64() const;    ///< if it fits
    std::uint64_t uint64() const;  ///< if it fits

    /// Of an object, which null becomes; of an array, likewise.
    void set(std::string_view key, JsonValue value);
    void push(JsonValue value);
    /// Null: this is no object, or has no such key.
    const JsonValue* find(std::string_view key) const;
    JsonValue* find(std::string_view key);
    /// Does nothing where the key is not there.
    void erase(std::string_view key);

    friend bool operator==(const JsonValue& a, const JsonValue& b);

  private:
    friend JsonValue parse_json(std::string_view text);
    friend std::string dump(const JsonValue& value, int indent);

    std::variant<std::nullptr_t, bool, std::int64_t, std::uint64_t, double, std::string, Array, Object>
        value_ = nullptr;
};

struct JsonMember {
    std::string key;
    JsonValue value;
    friend bool operator==(const JsonMember&, const JsonMember&) = default;
};

/// Throws std::invalid_argument with the reason: no JSON.
JsonValue parse_json(std::string_view text);
/// On one line, or with so many spaces per level. Numbers are written so that they read back as they are; a
/// number that is not finite is null.
std::string dump(const JsonValue& value, int indent = -1);

}  // namespace puckloop
