// A profile as text, for a person.

#include "debug/profile/profile.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::debug {

namespace {

constexpr std::size_t kMostFunctions = 30, kMostReads = 10, kMostNames = 5;

}  // namespace

std::map<std::uint32_t, Cost> function_costs(const Profile& profile, const FunctionNames& names) {
    std::map<std::uint32_t, Cost> functions;
    for (const auto& [pc, cost] : profile.costs())
        functions[names.start_of(pc)] += cost;
    return functions;
}

FunctionNames::FunctionNames(const Profile& profile, const Places& places)
    : symbols_(places.has_symbols()), starts_(places.functions()) {
    if (symbols_) return;
    for (const auto& [pc, vector] : profile.entries())
        starts_.try_emplace(pc, vector ? fmt::format("interrupt_0x{:06x}", pc) : fmt::format("0x{:06x}", pc));
}

std::uint32_t FunctionNames::start_of(std::uint32_t pc) const {
    const auto after = starts_.upper_bound(pc);
    return after == starts_.begin() ? 0 : std::prev(after)->first;
}

std::string FunctionNames::name_of(std::uint32_t start) const {
    const auto at = starts_.find(start);
    return at == starts_.end() ? fmt::format("0x{:06x}", start) : at->second;
}

std::optional<StackUse> stack_use(const Profile& profile, const Variables& variables, const DebugChip& chip) {
    const auto& stack = profile.stack();
    if (!stack) return std::nullopt;
    StackUse use;
    if (chip.stack_grows_up()) {  // the pointer is behind the last word
        use = {stack->base, stack->peak, std::nullopt, {}};
        const auto limit = chip.special("SPLIM");
        if (limit && limit->value > 0) use.left = limit->value > use.behind ? limit->value - use.behind : 0;
    } else {  // the pointer is below the last byte
        use = {stack->peak + 1, stack->base + 1, std::nullopt, {}};
        const std::uint32_t end = variables.end();
        if (end > 0) use.left = use.first > end ? use.first - end : 0;
    }
    use.over = variables.overlap(use.first, use.behind);
    return use;
}

std::string overlap_text(const StackUse& use) {
    if (use.over.bytes == 0) return {};
    std::string names;
    for (std::size_t i = 0; i < use.over.names.size() && i < kMostNames; ++i)
        names += (names.empty() ? " (" : ", ") + use.over.names[i];
    if (use.over.names.size() > kMostNames)
        names += fmt::format(" and {} more", use.over.names.size() - kMostNames);
    return fmt::format("the stack has grown over {} bytes of variables{}{}", use.over.bytes, names,
                       names.empty() ? "" : ")");
}

std::string stack_warning(const Profile& profile, const Variables& variables, const DebugChip& chip) {
    const auto use = stack_use(profile, variables, chip);
    return use ? overlap_text(*use) : std::string();
}

std::string profile_text(const Profile& profile, const Places& places, const Variables& variables,
                         const DebugChip& chip) {
    const FunctionNames names(profile, places);
    std::vector<std::pair<Cost, std::string>> functions;
    Cost total;
    for (const auto& [start, cost] : function_costs(profile, names)) {
        functions.emplace_back(cost, names.name_of(start));
        total += cost;
    }
    std::stable_sort(functions.begin(), functions.end(),
                     [](const auto& a, const auto& b) { return a.first.cycles > b.first.cycles; });
    std::string text = fmt::format("{:>14} {:>6} {:>14}  function\n", "cycles", "%", "instructions");
    for (std::size_t i = 0; i < functions.size() && i < kMostFunctions; ++i) {
        const auto& [cost, name] = functions[i];
        const double share = 100.0 * static_cast<double>(cost.cycles) / static_cast<double>(total.cycles);
        text += fmt::format("{:>14} {:>6.2f} {:>14}  {}\n", cost.cycles, share, cost.instructions, name);
    }
    if (functions.size() > kMostFunctions)
        text += fmt::format("{:>38}{} functions in all\n", "", functions.size());
    text += fmt::format("{:>14} {:>6} {:>14}  in all\n", total.cycles, "", total.instructions);
    const auto place = [&](std::uint32_t pc) {
        std::string found = fmt::format("0x{:06x}", pc);
        if (const std::string symbol = places.place(pc); !symbol.empty()) found += " " + symbol;
        if (const std::string line = places.lines().at(pc); !line.empty()) found += " (" + line + ")";
        return found;
    };
    if (const auto& stack = profile.stack())
        text += fmt::format("stack: {} bytes at most, 0x{:04x} from 0x{:04x}, at {}\n", stack->bytes(),
                            stack->peak, stack->base, place(stack->peak_pc));
    if (const auto use = stack_use(profile, variables, chip)) {
        if (use->left)
            text += fmt::format("stack: {} bytes left to {}\n", *use->left,
                                chip.stack_grows_up() ? "SPLIM" : "the variables");
        if (use->over.bytes > 0) text += fmt::format("warning: {}\n", overlap_text(*use));
    }
    const auto unwritten = profile.unwritten();
    if (unwritten.empty()) return text + "no byte of RAM was read before it was written\n";
    text += fmt::format("{} reads of bytes of RAM that nothing had written, at {} places:\n",
                        profile.unwritten_reads(), unwritten.size());
    for (std::size_t i = 0; i < unwritten.size() && i < kMostReads; ++i) {
        const std::string name = variables.name_at(unwritten[i].address);
        text += fmt::format("  0x{:04x}{} at {}, {} times\n", unwritten[i].address,
                            name.empty() ? "" : fmt::format(" ({})", name), place(unwritten[i].pc),
                            unwritten[i].times);
    }
    return text;
}

}  // namespace puckloop::debug
