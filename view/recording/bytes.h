#pragma once
// Numbers as bytes, little-endian, as the page's typed arrays take them.

#include <bit>
#include <cstring>
#include <span>
#include <string>

namespace puckloop::view {

static_assert(std::endian::native == std::endian::little, "pages get numbers as they are in memory");

template <class Number>
void append_number(std::string& out, Number value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    out.append(bytes, sizeof value);
}

template <class Number>
void append_numbers(std::string& out, std::span<const Number> values) {
    if (values.empty()) return;
    const std::size_t at = out.size();
    out.resize(at + values.size_bytes());
    std::memcpy(out.data() + at, values.data(), values.size_bytes());
}

}  // namespace puckloop::view
