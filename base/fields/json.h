#pragma once
// Structs with a list of their fields (field.h) as JSON and back, and what two of them differ in.
//
// Written are all fields but empty optionals. Read are those that are there: others keep their default.

#include "base/fields/field.h"
#include "base/fields/json_value.h"

#include <map>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop {

namespace detail {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

template <class T>
concept Map = requires {
    typename T::mapped_type;
};
template <class T>
concept Fixed = requires {
    std::tuple_size<T>::value;
};

[[noreturn]] void refuse_type(const JsonValue& value, const std::string& place);
[[noreturn]] void refuse_missing(std::string_view key, const std::string& place);
[[noreturn]] void refuse_key(std::string_view key, const std::string& place);
/// Throws InputError if `number` is out of the field's range.
void check_range(double number, double least, double most, bool open, std::string_view unit,
                 const std::string& place);
bool read_plain(bool& value, const JsonValue& from);
bool read_plain(double& value, const JsonValue& from);
bool read_plain(std::string& value, const JsonValue& from);
/// `least` to `most`: what the integer's type holds.
std::optional<std::int64_t> signed_from(const JsonValue& from, std::int64_t least, std::int64_t most);
std::optional<std::uint64_t> unsigned_from(const JsonValue& from, std::uint64_t most);
std::string inside(const std::string& place, std::string_view key);
std::string element(const std::string& place, std::size_t index);

}  // namespace detail

template <class T>
JsonValue to_value(const T& value);
template <class T>
void from_value(T& value, const JsonValue& from, const std::string& place);

/// Into an object, beside what it has.
template <Described T>
void write_fields(const T& value, JsonValue& object) {
    for_each_entry<T>([&]<class Entry>(const Entry& entry) {
        const auto write = [&]<class M, class Form>(const Field<T, M, Form>& one) {
            const M& member = value.*one.member;
            if constexpr (detail::IsOptional<M>::value)
                if (!member) return;
            if constexpr (std::is_same_v<Form, OwnForm>)
                object.set(one.key, to_value(member));
            else
                object.set(one.key, Form::write(member));
        };
        if constexpr (requires { entry.key; })
            write(entry);
        else if constexpr (std::is_same_v<Entry, Part<T, typename detail::MemberOf<Entry>::type>>)
            write_fields(value.*entry.member, object);
    });
}

template <class T>
JsonValue to_value(const T& value) {
    if constexpr (Described<T>) {
        JsonValue object = JsonValue::Object{};
        write_fields(value, object);
        return object;
    } else if constexpr (detail::IsOptional<T>::value) {
        return value ? to_value(*value) : JsonValue();
    } else if constexpr (detail::Map<T>) {
        JsonValue object = JsonValue::Object{};
        for (const auto& [key, one] : value)
            object.set(key, to_value(one));
        return object;
    } else if constexpr (std::is_constructible_v<JsonValue, const T&>) {
        return JsonValue(value);
    } else {
        static_assert(std::ranges::range<T>, "a field of this type needs a form of its own (Field::as)");
        JsonValue list = JsonValue::Array{};
        for (const auto& one : value)
            list.push(to_value(one));
        return list;
    }
}

/// Sets the fields of which `object` has the key. Throws InputError naming `place` and key: a wrong type, a
/// number out of range, a key that must be there.
template <Described T>
void read_fields(T& value, const JsonValue& object, const std::string& place) {
    for_each_entry<T>([&]<class Entry>(const Entry& entry) {
        const auto read = [&]<class M, class Form>(const Field<T, M, Form>& one) {
            const JsonValue* found = object.find(one.key);
            if (found == nullptr) {
                if (one.needed) detail::refuse_missing(one.key, place);
                return;
            }
            const std::string where = detail::inside(place, one.key);
            M& member = value.*one.member;
            if constexpr (std::is_same_v<Form, OwnForm>)
                from_value(member, *found, where);
            else
                Form::read(member, *found, where);
            const auto check = [&](const JsonValue& number) {
                if (number.is_number())
                    detail::check_range(number.number(), one.least, one.most, one.open, one.unit, where);
            };
            check(*found);
            if (const JsonValue::Array* list = found->array())
                for (const JsonValue& number : *list)
                    check(number);
        };
        if constexpr (requires { entry.key; })
            read(entry);
        else if constexpr (std::is_same_v<Entry, Part<T, typename detail::MemberOf<Entry>::type>>)
            read_fields(value.*entry.member, object, place);
    });
}

template <Described T>
bool has_key(std::string_view key) {
    bool found = false;
    for_each_entry<T>([&]<class Entry>(const Entry& entry) {
        if constexpr (requires { entry.key; })
            found = found || entry.key == key;
        else if constexpr (std::is_same_v<Entry, Part<T, typename detail::MemberOf<Entry>::type>>)
            found = found || has_key<typename detail::MemberOf<Entry>::type>(key);
    });
    return found;
}

/// Throws InputError as read_fields() does, and for keys that `value` has not.
template <class T>
void from_value(T& value, const JsonValue& from, const std::string& place) {
    if constexpr (Described<T>) {
        if (from.object() == nullptr) detail::refuse_type(from, place);
        for (const JsonMember& member : *from.object())
            if (!has_key<T>(member.key)) detail::refuse_key(member.key, place);
        read_fields(value, from, place);
    } else if constexpr (detail::IsOptional<T>::value) {
        value.reset();
        if (!from.is_null()) from_value(value.emplace(), from, place);
    } else if constexpr (detail::Map<T>) {
        if (from.object() == nullptr) detail::refuse_type(from, place);
        value.clear();
        for (const JsonMember& member : *from.object())
            from_value(value[member.key], member.value, detail::inside(place, member.key));
    } else if constexpr (requires { detail::read_plain(value, from); }) {
        if (!detail::read_plain(value, from)) detail::refuse_type(from, place);
    } else if constexpr (std::is_integral_v<T>) {
        using Limits = std::numeric_limits<T>;
        if constexpr (std::is_signed_v<T>) {
            const auto number = detail::signed_from(from, Limits::min(), Limits::max());
            if (!number) detail::refuse_type(from, place);
            value = static_cast<T>(*number);
        } else {
            const auto number = detail::unsigned_from(from, Limits::max());
            if (!number) detail::refuse_type(from, place);
            value = static_cast<T>(*number);
        }
    } else {
        static_assert(std::ranges::range<T>, "a field of this type needs a form of its own (Field::as)");
        if (from.array() == nullptr) detail::refuse_type(from, place);
        const JsonValue::Array& list = *from.array();
        if constexpr (detail::Fixed<T>) {
            if (list.size() != value.size()) detail::refuse_type(from, place);
        } else {
            value.clear();
            value.resize(list.size());
        }
        for (std::size_t i = 0; i < list.size(); ++i)
            from_value(value[i], list[i], detail::element(place, i));
    }
}

/// The fields that count in `comparison` as an object.
template <Described T>
void write_compared(const T& value, Comparison comparison, JsonValue& object) {
    write_fields(value, object);
    for_each_entry<T>([&]<class Entry>(const Entry& entry) {
        if constexpr (requires { entry.key; }) {
            if (!(comparison == Comparison::State ? entry.in_state : entry.in_run)) object.erase(entry.key);
        } else if constexpr (std::is_same_v<Entry, Part<T, typename detail::MemberOf<Entry>::type>>) {
            write_compared(value.*entry.member, comparison, object);
        }
    });
}

}  // namespace puckloop
