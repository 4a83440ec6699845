// A profile in other tools' formats.
// Sources: Valgrind manual, "Callgrind Format Specification"; geninfo(1), section "Files".

#include "debug/profile/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::debug {

namespace {

struct SourceLine {
    std::string file = "???";
    std::uint32_t line = 0;
};

/// "main.c:12" taken apart.
SourceLine line_at(const Places& places, std::uint32_t pc) {
    const std::string text = places.lines().at(pc);
    const std::size_t colon = text.rfind(':');
    if (colon == std::string::npos) return {};
    return {text.substr(0, colon), static_cast<std::uint32_t>(std::stoul(text.substr(colon + 1)))};
}

}  // namespace

std::string callgrind_text(const Profile& profile, const Places& places, const std::string& image,
                           const DebugChip& chip) {
    const FunctionNames names(profile, places);
    const std::map<std::uint32_t, Cost> costs = profile.costs();
    Cost total;
    for (const auto& [pc, cost] : costs)
        total += cost;
    std::string text = fmt::format("# callgrind format\nversion: 1\ncreator: puckloop\ncmd: {} on {}\n"
                                   "positions: instr line\nevents: Cycles Instructions\nsummary: {} {}\n\n"
                                   "ob={}\n",
                                   image, chip.name(), total.cycles, total.instructions, image);
    std::uint32_t function = ~0u;
    std::string file;
    const auto& calls = profile.calls();
    for (const auto& [pc, cost] : costs) {
        const SourceLine line = line_at(places, pc);
        if (names.start_of(pc) != function) {
            function = names.start_of(pc);
            file = line_at(places, function).file;
            text += fmt::format("\nfl={}\nfn={}\n", file, names.name_of(function));
        }
        if (line.file != file) text += fmt::format("fi={}\n", file = line.file);
        text += fmt::format("0x{:x} {} {} {}\n", pc, line.line, cost.cycles, cost.instructions);
        for (auto at = calls.lower_bound({pc, 0}); at != calls.end() && at->first.first == pc; ++at) {
            const std::uint32_t callee = at->first.second;
            const SourceLine target = line_at(places, callee);
            text +=
                fmt::format("cfi={}\ncfn={}\ncalls={} 0x{:x} {}\n0x{:x} {} {} {}\n", target.file,
                            names.name_of(names.start_of(callee)), at->second.times, callee, target.line, pc,
                            line.line, at->second.inclusive.cycles, at->second.inclusive.instructions);
        }
    }
    return text;
}

std::string lcov_text(const Profile& profile, const Places& places, const std::string& folder) {
    const std::map<std::uint32_t, Cost> costs = profile.costs();
    const auto executed = [&](std::uint32_t pc) {
        const auto at = costs.find(pc);
        return at == costs.end() ? std::uint64_t{0} : at->second.instructions;
    };
    struct File {
        std::map<std::uint32_t, std::uint64_t> lines;                              ///< executions
        std::map<std::string, std::pair<std::uint32_t, std::uint64_t>> functions;  ///< line, calls
    };
    std::map<std::string, File> files;
    // A line is as often executed as the stretch of its code that is so most often.
    for (const image::LineTable::Stretch& stretch : places.lines().stretches()) {
        std::uint64_t& times = files[std::string(stretch.file)].lines[stretch.line];
        times = std::max(times, executed(stretch.address));
    }
    for (const auto& [pc, name] : places.functions())
        if (const SourceLine line = line_at(places, pc); line.line != 0)
            files[line.file].functions[name] = {line.line, executed(pc)};
    std::string text;
    for (const auto& [name, file] : files) {
        text +=
            fmt::format("TN:\nSF:{}\n", folder.empty() || name.starts_with('/') ? name : folder + "/" + name);
        std::size_t hit = 0;
        for (const auto& [function, entry] : file.functions)
            text += fmt::format("FN:{},{}\n", entry.first, function);
        for (const auto& [function, entry] : file.functions) {
            text += fmt::format("FNDA:{},{}\n", entry.second, function);
            hit += entry.second > 0;
        }
        text += fmt::format("FNF:{}\nFNH:{}\n", file.functions.size(), hit);
        hit = 0;
        for (const auto& [line, times] : file.lines) {
            text += fmt::format("DA:{},{}\n", line, times);
            hit += times > 0;
        }
        text += fmt::format("LF:{}\nLH:{}\nend_of_record\n", file.lines.size(), hit);
    }
    return text;
}

}  // namespace puckloop::debug
