#include "base/plain_text.h"

#include <fmt/format.h>

#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <new>
#include <stdexcept>

namespace puckloop {

namespace {

bool continues(char c) {
    return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

/// One character in front of `text`; no `bytes`: not UTF-8.
struct Character {
    std::uint32_t code = 0;
    std::size_t bytes = 0;
};

Character first_of(std::string_view text) {
    const auto lead = static_cast<unsigned char>(text.front());
    if (lead < 0x80) return {lead, 1};
    const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
    if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
    std::uint32_t code = lead & (0x7fU >> bytes);
    for (std::size_t i = 1; i < bytes; ++i) {
        if (!continues(text[i])) return {};
        code = code << 6 | (static_cast<unsigned char>(text[i]) & 0x3fU);
    }
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = code >= 0xd800 && code <= 0xdfff;
    if (code < kLeast[bytes] || code > 0x10ffff || surrogate) return {};
    return {code, bytes};
}

/// What a terminal acts on rather than shows.
bool obeyed(std::uint32_t code) {
    const auto within = [code](std::uint32_t first, std::uint32_t last) {
        return code >= first && code <= last;
    };
    return code < 0x20 || within(0x7f, 0x9f) || code == 0x61c || within(0x200e, 0x200f) ||
           within(0x2028, 0x202e) || within(0x2066, 0x2069) || code == 0xfeff;
}

std::string escape_of(std::uint32_t code) {
    switch (code) {
    case '\n':
        return "\\n";
    case '\t':
        return "\\t";
    case '\r':
        return "\\r";
    default:
        return code < 0x100 ? fmt::format("\\x{:02x}", code) : fmt::format("\\u{:04x}", code);
    }
}

std::string shown(std::string_view text, bool lines) {
    std::string plain;
    while (!text.empty()) {
        const Character one = first_of(text);
        const std::size_t bytes = std::max<std::size_t>(one.bytes, 1);
        if (one.bytes == 0)
            plain += fmt::format("\\x{:02x}", static_cast<unsigned char>(text.front()));
        else if (!obeyed(one.code) || (lines && one.code == '\n'))
            plain += text.substr(0, bytes);
        else
            plain += escape_of(one.code);
        text.remove_prefix(bytes);
    }
    return plain;
}

std::string with_commas(std::size_t number) {
    constexpr std::size_t kThousand = 1000;
    if (number < kThousand) return std::to_string(number);
    return fmt::format("{},{:03}", with_commas(number / kThousand), number % kThousand);
}

std::string cut(std::string_view text, std::size_t most, bool lines) {
    constexpr std::size_t kLeast = 64;
    most = std::max(most, kLeast);
    if (text.size() <= most) return shown(text, lines);
    // No character is cut in two: it would be shown as bytes.
    std::size_t head = most / 2, tail = text.size() - most / 2;
    while (head > 0 && continues(text[head]))
        --head;
    while (tail < text.size() && continues(text[tail]))
        ++tail;
    return fmt::format("{} ... ({} bytes left out) ... {}", shown(text.substr(0, head), lines),
                       with_commas(tail - head), shown(text.substr(tail), lines));
}

/// Memory that processes share is a file to the kernel.
bool file_sizes_are_limited() {
    rlimit limit{};
    return ::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

}  // namespace

std::string reason_of(const std::exception& error) {
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr)
        return file_sizes_are_limited() ? "not enough memory, or files are limited to less (ulimit -f)"
                                        : "not enough memory";
    if (dynamic_cast<const std::length_error*>(&error) != nullptr ||
        dynamic_cast<const std::out_of_range*>(&error) != nullptr)
        return "a size or an index is out of range, as of a damaged file";
    const std::string_view text = error.what();
    if (text.starts_with("[json.exception")) return "a description is damaged";
    return std::string(text);
}

std::string plain_text(std::string_view text, std::size_t most) {
    return cut(text, most, false);
}

std::string plain_lines(std::string_view text, std::size_t most) {
    return cut(text, most, true);
}

}  // namespace puckloop
