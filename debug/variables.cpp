#include "debug/variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <tuple>

namespace puckloop::debug {

namespace {

/// Of avr-gcc's linker scripts: behind .data, .bss and .noinit. The heap begins there.
constexpr std::array<std::string_view, 5> kEnds{"_end", "__bss_end", "__data_end", "__noinit_end",
                                                "__heap_start"};

}  // namespace

Variables::Variables(const std::map<std::string, image::Symbol>& symbols,
                     const std::map<std::string, std::uint32_t>& sizes, std::uint32_t ram_start,
                     std::uint32_t ram_end, bool stack_from_above) {
    for (const auto& [name, symbol] : symbols) {
        if (symbol.space != image::Space::Data) continue;
        const bool is_end = std::find(kEnds.begin(), kEnds.end(), name) != kEnds.end();
        if (is_end && stack_from_above && symbol.address > ram_start && symbol.address <= ram_end)
            ranges_.push_back({ram_start, symbol.address, {}});
        if (name.starts_with("__") || is_end) continue;  // the linker's marks
        if (symbol.address < ram_start || symbol.address >= ram_end) continue;
        const auto size = sizes.find(name);
        const std::uint32_t bytes = size == sizes.end() ? 1 : std::max(size->second, 1u);
        ranges_.push_back({symbol.address, symbol.address + bytes, name});
    }
    std::sort(ranges_.begin(), ranges_.end(), [](const Range& a, const Range& b) {
        return std::tie(a.first, a.behind, a.name) < std::tie(b.first, b.behind, b.name);
    });
    for (const Range& range : ranges_)
        end_ = std::max(end_, range.behind);
}

Variables::Overlap Variables::overlap(std::uint32_t first, std::uint32_t behind) const {
    Overlap found;
    std::uint32_t counted = first;
    for (const Range& range : ranges_) {
        if (range.behind <= first || range.first >= behind) continue;
        const std::uint32_t last = std::min(range.behind, behind);
        const std::uint32_t from = std::max(range.first, counted);
        if (last > from) found.bytes += last - from;
        counted = std::max(counted, last);
        if (!range.name.empty()) found.names.push_back(range.name);
    }
    return found;
}

std::string Variables::name_at(std::uint32_t address) const {
    for (auto range = ranges_.rbegin(); range != ranges_.rend(); ++range) {
        if (range->name.empty() || address < range->first || address >= range->behind) continue;
        return address == range->first ? range->name
                                       : fmt::format("{}+{}", range->name, address - range->first);
    }
    return {};
}

}  // namespace puckloop::debug
