#include "base/states/archive.h"

#include <fmt/format.h>

namespace puckloop {

void StateReader::fail(std::string_view problem) const {
    std::string place;
    for (const Open& part : open_)
        place += part.name + ", ";
    if (!place.empty()) place.replace(place.size() - 2, 2, ": ");
    throw StateError(fmt::format("{}{} (byte {} of {})", place, problem, position_, bytes_.size()));
}

std::uint64_t StateReader::number(std::size_t size) {
    if (left() < size) fail("ends too early");
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
        value |= static_cast<std::uint64_t>(bytes_[position_ + i]) << (8 * i);
    position_ += size;
    return value;
}

void StateReader::begin_part(std::string_view name) {
    std::string found;
    get(found);
    if (found != name) {
        constexpr std::size_t kShown = 32;
        for (char& c : found)
            if (c < ' ' || c > '~') c = '?';
        fail(fmt::format("part '{}' where '{}' is expected", found.substr(0, kShown), name));
    }
    const std::size_t length = count();
    open_.push_back({std::string(name), bytes_, position_ + length});
    bytes_ = bytes_.first(position_ + length);
}

void StateReader::end_part() {
    if (left() != 0) fail("more bytes than expected");
    bytes_ = open_.back().outer;
    open_.pop_back();
}

}  // namespace puckloop
