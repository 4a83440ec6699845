#pragma once
// Mutable state as bytes. A struct lists what it remembers once, in a member
//     template <class Archive> void state(Archive& archive) { archive(count_, level_); }
// (or a free function state(archive, object) beside a plain struct), and StateWriter and StateReader go
// through that list. Numbers are little-endian; a part has its name and its length, so that a state which
// does not fit is refused with its place. Reading changes nothing outside the object and never trusts a
// length, a flag or a bounded number.

#include <array>
#include <bit>
#include <concepts>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace puckloop {

/// A state that does not fit: what() is "chip, uart1: ends too early".
class StateError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

namespace archive_detail {
template <class T>
struct IsContainer : std::false_type {};
template <class T>
struct IsContainer<std::vector<T>> : std::true_type {};
template <class T>
struct IsContainer<std::deque<T>> : std::true_type {};
template <class T>
struct IsArray : std::false_type {};
template <class T, std::size_t n>
struct IsArray<std::array<T, n>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsMap : std::false_type {};
template <class Key, class Value>
struct IsMap<std::map<Key, Value>> : std::true_type {};
template <class T>
struct IsPair : std::false_type {};
template <class A, class B>
struct IsPair<std::pair<A, B>> : std::true_type {};

/// The unsigned integer that carries a number or an enumerator.
template <class T>
auto bits_of(T value) {
    if constexpr (std::is_enum_v<T>)
        return bits_of(static_cast<std::underlying_type_t<T>>(value));
    else if constexpr (std::floating_point<T>)
        return std::bit_cast<std::uint64_t>(static_cast<double>(value));
    else if constexpr (std::same_as<T, bool>)
        return static_cast<std::uint8_t>(value);
    else
        return static_cast<std::make_unsigned_t<T>>(value);
}
}  // namespace archive_detail

class StateWriter {
  public:
    static constexpr bool kLoads = false;
    static constexpr bool kRaw = false;  ///< true of the archives of base/states/checkpoint.h

    explicit StateWriter(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

    template <class... T>
    void operator()(const T&... values) {
        (put(values), ...);
    }
    /// A number or enumerator that lies in low..high: what indexes something.
    template <class T>
    void bounded(const T& value, std::type_identity_t<T>, std::type_identity_t<T>) {
        put(value);
    }
    /// A container whose size does not change in the object's life.
    template <class T>
    void fixed(const T& container) {
        put(container);
    }
    /// Containers that are only ever appended to: a checkpoint keeps no more than their sizes.
    template <class... T>
    void grows(const T&... containers) {
        (put(containers), ...);
    }
    /// What a checkpoint leaves out, because its owner takes changes back by other means.
    template <class... T>
    void apart(const T&... values) {
        (put(values), ...);
    }
    /// Reading only: throws StateError unless `holds`.
    void check(bool, std::string_view) {}
    /// Part `number` of several with one name.
    template <class T>
    void part(std::string_view name, std::size_t number, const T& value) {
        part(std::string(name) + std::to_string(number), value);
    }
    /// Named, with its length.
    template <class T>
    void part(std::string_view name, const T& value) {
        put(std::string(name));
        const std::size_t at = bytes_.size();
        number(0, 4);
        put(value);
        const std::size_t length = bytes_.size() - at - 4;
        for (std::size_t i = 0; i < 4; ++i)
            bytes_[at + i] = static_cast<std::uint8_t>(length >> (8 * i));
    }

  private:
    void number(std::uint64_t value, std::size_t size) {
        for (std::size_t i = 0; i < size; ++i)
            bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    }
    template <class T>
    void put(const T& value) {
        using namespace archive_detail;
        if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            const auto bits = bits_of(value);
            number(bits, sizeof bits);
        } else if constexpr (std::same_as<T, std::string> || IsContainer<T>::value || IsMap<T>::value) {
            number(value.size(), 4);
            for (const auto& item : value)
                put(item);
        } else if constexpr (IsArray<T>::value) {
            for (const auto& item : value)
                put(item);
        } else if constexpr (IsOptional<T>::value) {
            put(value.has_value());
            if (value) put(*value);
        } else if constexpr (IsPair<T>::value) {
            put(value.first);
            put(value.second);
        } else if constexpr (requires { const_cast<T&>(value).state(*this); }) {
            const_cast<T&>(value).state(*this);  // one list for both directions; this one only reads
        } else {
            state(*this, const_cast<T&>(value));
        }
    }

    std::vector<std::uint8_t>& bytes_;
};

class StateReader {
  public:
    static constexpr bool kLoads = true;
    static constexpr bool kRaw = false;

    explicit StateReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    template <class... T>
    void operator()(T&... values) {
        (get(values), ...);
    }
    template <class T>
    void bounded(T& value, std::type_identity_t<T> low, std::type_identity_t<T> high) {
        get(value);
        // A NaN is in no range.
        if (!(value >= low && value <= high)) fail("a number is out of range");
    }
    template <class T>
    void fixed(T& container) {
        if (number(4) != container.size()) fail("another size");
        for (auto& item : container)
            get(item);
    }
    template <class... T>
    void grows(T&... containers) {
        (get(containers), ...);
    }
    template <class... T>
    void apart(T&... values) {
        (get(values), ...);
    }
    void check(bool holds, std::string_view problem) {
        if (!holds) fail(problem);
    }
    template <class T>
    void part(std::string_view name, std::size_t number, T& value) {
        part(std::string(name) + std::to_string(number), value);
    }
    template <class T>
    void part(std::string_view name, T& value) {
        begin_part(name);
        get(value);
        end_part();
    }

    std::size_t left() const { return bytes_.size() - position_; }
    /// Throws unless everything was read.
    void end() const {
        if (left() != 0) fail("more bytes than expected");
    }
    [[noreturn]] void fail(std::string_view problem) const;

  private:
    struct Open {
        std::string name;
        std::span<const std::uint8_t> outer;
        std::size_t after = 0;
    };
    void begin_part(std::string_view name);
    void end_part();
    std::uint64_t number(std::size_t size);

    template <class T>
    void get(T& value) {
        using namespace archive_detail;
        if constexpr (std::same_as<T, bool>) {
            const std::uint64_t bits = number(1);
            if (bits > 1) fail("a flag is neither 0 nor 1");
            value = bits == 1;
        } else if constexpr (std::floating_point<T>) {
            value = static_cast<T>(std::bit_cast<double>(number(8)));
        } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>) {
            value = static_cast<T>(number(sizeof(bits_of(value))));
        } else if constexpr (std::same_as<T, std::string>) {
            value.resize(count());
            for (char& c : value)
                c = static_cast<char>(number(1));
        } else if constexpr (IsContainer<T>::value) {
            const std::size_t items = count();
            value.clear();
            for (std::size_t i = 0; i < items; ++i) {
                typename T::value_type item{};
                get(item);
                value.push_back(std::move(item));
            }
        } else if constexpr (IsMap<T>::value) {
            value.clear();
            for (std::size_t items = count(); items > 0; --items) {
                std::pair<typename T::key_type, typename T::mapped_type> item{};
                get(item);
                value.insert(std::move(item));
            }
        } else if constexpr (IsArray<T>::value) {
            for (auto& item : value)
                get(item);
        } else if constexpr (IsOptional<T>::value) {
            bool has = false;
            get(has);
            value.reset();
            if (has) get(value.emplace());
        } else if constexpr (IsPair<T>::value) {
            get(value.first);
            get(value.second);
        } else if constexpr (requires { value.state(*this); }) {
            value.state(*this);
        } else {
            state(*this, value);
        }
    }
    /// A number of items, each of at least one byte of what is left.
    std::size_t count() {
        const std::uint64_t items = number(4);
        if (items > left()) fail("a length beyond the end");
        return static_cast<std::size_t>(items);
    }

    std::span<const std::uint8_t> bytes_;
    std::size_t position_ = 0;
    std::vector<Open> open_;
};

}  // namespace puckloop
