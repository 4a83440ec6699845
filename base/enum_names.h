#pragma once
// An enumeration whose values 0, 1, 2, ... have their names in an array.

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace puckloop {

template <class Enum, std::size_t N>
constexpr std::optional<Enum> value_named(const std::array<std::string_view, N>& names,
                                          std::string_view name) {
    for (std::size_t i = 0; i < N; ++i)
        if (names[i] == name) return static_cast<Enum>(i);
    return std::nullopt;
}

}  // namespace puckloop
