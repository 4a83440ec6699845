#pragma once
// A copy of mutable state in memory, to go back to within microseconds, made from the same lists as a saved
// state (base/states/archive.h): raw, without names or checks, into a buffer that is kept. Only the very
// object that a checkpoint was taken of can go back to it.
//
// What can be copied byte for byte (numbers, pointers, plain structs) is copied whole, whatever its list
// states; an object with references or containers goes through its list.

#include "base/states/archive.h"

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <memory>
#include <string_view>
#include <type_traits>

namespace puckloop {

namespace archive_detail {
/// Copied byte for byte, and put back so.
template <class T>
concept Plain = std::is_trivially_copyable_v<T> && std::is_copy_assignable_v<T>;
/// Its items lie side by side and are plain.
template <class T>
concept PlainItems = requires(T& container) {
    { container.data() } -> std::contiguous_iterator;
}
&&Plain<typename T::value_type>;
}  // namespace archive_detail

class Checkpoint {
  public:
    /// Replaces what it held.
    template <class T>
    void take(const T& object);
    /// Puts the object back to what it was when it was taken.
    template <class T>
    void restore(T& object) const;
    std::size_t size() const { return size_; }  ///< bytes held

  private:
    friend class CheckpointWriter;
    friend class CheckpointReader;
    void grow(std::size_t needed) {
        constexpr std::size_t kFirst = 4096;
        const std::size_t room = std::max({needed, 2 * room_, kFirst});
        auto bytes = std::make_unique<std::byte[]>(room);
        if (size_ > 0) std::memcpy(bytes.get(), bytes_.get(), size_);
        bytes_ = std::move(bytes);
        room_ = room;
    }

    std::unique_ptr<std::byte[]> bytes_;
    std::size_t room_ = 0;
    std::size_t size_ = 0;
};

class CheckpointWriter {
  public:
    static constexpr bool kLoads = false;
    static constexpr bool kRaw = true;

    explicit CheckpointWriter(Checkpoint& checkpoint) : to_(checkpoint) { to_.size_ = 0; }

    template <class... T>
    void operator()(const T&... values) {
        (put(values), ...);
    }
    template <class T>
    void bounded(const T& value, std::type_identity_t<T>, std::type_identity_t<T>) {
        put(value);
    }
    template <class T>
    void fixed(const T& container) {
        using namespace archive_detail;
        if constexpr (PlainItems<const T>)
            raw(container.data(), container.size() * sizeof(typename T::value_type));
        else
            for (const auto& item : container)
                put(item);
    }
    template <class... T>
    void grows(const T&... containers) {
        (put(containers.size()), ...);
    }
    template <class... T>
    void apart(const T&...) {}
    void check(bool, std::string_view) {}
    template <class T>
    void part(std::string_view, const T& value) {
        put(value);
    }
    template <class T>
    void part(std::string_view, std::size_t, const T& value) {
        put(value);
    }

  private:
    void raw(const void* from, std::size_t size) {
        const std::size_t end = to_.size_ + size;
        if (end > to_.room_) [[unlikely]]
            to_.grow(end);
        if (size > 0) std::memcpy(to_.bytes_.get() + to_.size_, from, size);
        to_.size_ = end;
    }
    template <class T>
    void put(const T& value) {
        using namespace archive_detail;
        if constexpr (Plain<T>) {
            raw(&value, sizeof value);
        } else if constexpr (PlainItems<const T>) {
            put(value.size());
            fixed(value);
        } else if constexpr (IsContainer<T>::value || IsMap<T>::value) {
            put(value.size());
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
            const_cast<T&>(value).state(*this);  // as StateWriter: this one only reads
        } else {
            state(*this, const_cast<T&>(value));
        }
    }

    Checkpoint& to_;
};

class CheckpointReader {
  public:
    static constexpr bool kLoads = true;
    static constexpr bool kRaw = true;

    explicit CheckpointReader(const Checkpoint& checkpoint) : next_(checkpoint.bytes_.get()) {}

    template <class... T>
    void operator()(T&... values) {
        (get(values), ...);
    }
    template <class T>
    void bounded(T& value, std::type_identity_t<T>, std::type_identity_t<T>) {
        get(value);
    }
    template <class T>
    void fixed(T& container) {
        using namespace archive_detail;
        if constexpr (PlainItems<T>)
            raw(container.data(), container.size() * sizeof(typename T::value_type));
        else
            for (auto& item : container)
                get(item);
    }
    template <class... T>
    void grows(T&... containers) {
        (shrink(containers), ...);
    }
    template <class... T>
    void apart(T&...) {}
    void check(bool, std::string_view) {}
    template <class T>
    void part(std::string_view, T& value) {
        get(value);
    }
    template <class T>
    void part(std::string_view, std::size_t, T& value) {
        get(value);
    }

  private:
    void raw(void* to, std::size_t size) {
        if (size > 0) std::memcpy(to, next_, size);
        next_ += size;
    }
    std::size_t count() {
        std::size_t size = 0;
        raw(&size, sizeof size);
        return size;
    }
    template <class T>
    void shrink(T& container) {
        container.erase(std::next(container.begin(), static_cast<std::ptrdiff_t>(count())), container.end());
    }
    template <class T>
    void get(T& value) {
        using namespace archive_detail;
        if constexpr (Plain<T>) {
            raw(&value, sizeof value);
        } else if constexpr (PlainItems<T>) {
            value.resize(count());
            fixed(value);
        } else if constexpr (IsContainer<T>::value) {
            value.resize(count());
            for (auto& item : value)
                get(item);
        } else if constexpr (IsMap<T>::value) {
            get_map(value);
        } else if constexpr (IsArray<T>::value) {
            for (auto& item : value)
                get(item);
        } else if constexpr (IsOptional<T>::value) {
            bool has = false;
            get(has);
            if (!has)
                value.reset();
            else
                get(value ? *value : value.emplace());
        } else if constexpr (IsPair<T>::value) {
            get(value.first);
            get(value.second);
        } else if constexpr (requires { value.state(*this); }) {
            value.state(*this);
        } else {
            state(*this, value);
        }
    }
    /// Places that are there already are used again.
    template <class T>
    void get_map(T& map) {
        auto at = map.begin();
        for (std::size_t left = count(); left > 0; --left) {
            typename T::key_type key{};
            get(key);
            while (at != map.end() && map.key_comp()(at->first, key))
                at = map.erase(at);
            if (at == map.end() || map.key_comp()(key, at->first))
                at = map.emplace_hint(at, std::move(key), typename T::mapped_type{});
            get(at->second);
            ++at;
        }
        map.erase(at, map.end());
    }

    const std::byte* next_;
};

template <class T>
void Checkpoint::take(const T& object) {
    CheckpointWriter (*this)(object);
}

template <class T>
void Checkpoint::restore(T& object) const {
    CheckpointReader{*this}(object);
}

}  // namespace puckloop
