#include "debug/register_fields.h"

#include <charconv>

namespace puckloop::debug {

std::vector<DebugChip::Field> fields_of(std::string_view table, std::uint32_t value) {
    std::vector<DebugChip::Field> fields;
    while (!table.empty()) {
        const std::size_t end = std::min(table.find(' '), table.size());
        const std::string_view entry = table.substr(0, end);
        table.remove_prefix(end == table.size() ? end : end + 1);
        const std::size_t colon = entry.find(':');
        if (colon == std::string_view::npos) continue;
        unsigned high = 0;
        const char* const last = entry.data() + entry.size();
        const char* next = std::from_chars(entry.data() + colon + 1, last, high).ptr;
        unsigned low = high;
        if (next != last) std::from_chars(next + 1, last, low);
        const std::uint32_t mask = (2u << (high - low)) - 1;
        fields.push_back({std::string(entry.substr(0, colon)), value >> low & mask, static_cast<int>(low),
                          static_cast<int>(high - low + 1)});
    }
    return fields;
}

}  // namespace puckloop::debug
