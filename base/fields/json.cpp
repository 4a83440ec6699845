#include "base/fields/json.h"

#include "base/error.h"

#include <fmt/format.h>

namespace puckloop::detail {

void refuse_type(const JsonValue& value, const std::string& place) {
    throw InputError("", place, "has the wrong type: " + dump(value));
}

void refuse_missing(std::string_view key, const std::string& place) {
    throw InputError("", place, fmt::format("has no {}", key));
}

void refuse_key(std::string_view key, const std::string& place) {
    throw InputError("", inside(place, key), "unknown key");
}

void check_range(double number, double least, double most, bool open, std::string_view unit,
                 const std::string& place) {
    if ((open ? number > least : number >= least) && number <= most) return;
    const std::string in = unit.empty() ? "" : fmt::format(" {}", unit);
    constexpr double kNoLimit = std::numeric_limits<double>::infinity();
    if (most == kNoLimit)
        throw InputError("", place, fmt::format("must be {} {:g}{}", open ? "above" : "at least", least, in));
    throw InputError("", place,
                     fmt::format("must be {}{:g} to {:g}{}", open ? "above " : "", least, most, in));
}

bool read_plain(bool& value, const JsonValue& from) {
    if (from.boolean() == nullptr) return false;
    value = *from.boolean();
    return true;
}

bool read_plain(double& value, const JsonValue& from) {
    if (!from.is_number()) return false;
    value = from.number();
    return true;
}

bool read_plain(std::string& value, const JsonValue& from) {
    if (from.text() == nullptr) return false;
    value = *from.text();
    return true;
}

std::optional<std::int64_t> signed_from(const JsonValue& from, std::int64_t least, std::int64_t most) {
    if (!from.fits_int64() || from.int64() < least || from.int64() > most) return std::nullopt;
    return from.int64();
}

std::optional<std::uint64_t> unsigned_from(const JsonValue& from, std::uint64_t most) {
    if (!from.fits_uint64() || from.uint64() > most) return std::nullopt;
    return from.uint64();
}

std::string inside(const std::string& place, std::string_view key) {
    return place.empty() ? std::string(key) : fmt::format("{}.{}", place, key);
}

std::string element(const std::string& place, std::size_t index) {
    return fmt::format("{}[{}]", place, index);
}

}  // namespace puckloop::detail
