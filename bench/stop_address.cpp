// `--stop-at SYMBOL|0xPC|FILE:LINE`.

#include "base/error.h"
#include "base/text/suggest.h"
#include "bench/options.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>
#include <vector>

namespace puckloop::exec {

namespace {

constexpr std::uint32_t kHighestProgramAddress = 0x7FFFFE;

std::vector<StopAddress> resolve_line(const std::string& text, std::size_t colon, const image::Image& image,
                                      const LineLookup& lines) {
    std::uint32_t line = 0;
    const char* const last = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data() + colon + 1, last, line);
    if (error != std::errc{} || end != last || colon == 0)
        throw InputError("", "--stop-at", fmt::format("'{}' is not a source line", text),
                         "FILE:LINE, such as main.c:12");
    std::vector<StopAddress> stops;
    for (const std::uint32_t pc : lines(text.substr(0, colon), line))
        stops.push_back({pc, text});
    if (stops.empty())
        throw InputError(image.file, "--stop-at", fmt::format("no code of line {}", text),
                         "a line with code, and an ELF of avr-gcc -g");
    return stops;
}

}  // namespace

std::vector<StopAddress> resolve_stop(const std::string& text, const image::Image& image,
                                      const LineLookup& lines) {
    if (const std::size_t colon = text.rfind(':'); colon != std::string::npos)
        return resolve_line(text, colon, image, lines);
    if (text.starts_with("0x") || text.starts_with("0X")) {
        std::uint32_t pc = 0;
        const char* const last = text.data() + text.size();
        const auto [end, error] = std::from_chars(text.data() + 2, last, pc, 16);
        if (error != std::errc{} || end != last || text.size() == 2 || pc > kHighestProgramAddress ||
            pc % 2 != 0)
            throw InputError("", "--stop-at", fmt::format("'{}' is not a program address", text),
                             "an even one, such as 0x1f48");
        return {{pc, text}};
    }
    if (const auto pc = image.find_code(text)) return {{*pc, text}};
    if (image.symbols.empty())
        throw InputError(image.file, "--stop-at",
                         fmt::format("the image has no symbols, so '{}' is unknown", text),
                         "0xPC, or an ELF or COFF image");
    std::vector<std::string_view> known;
    for (const auto& [name, symbol] : image.symbols) {
        if (symbol.space != image::Space::Program) continue;
        known.push_back(name);
        // A C function carries an underscore, which nobody types.
        if (name.starts_with("_")) known.push_back(std::string_view(name).substr(1));
    }
    throw InputError(image.file, "--stop-at", fmt::format("no symbol '{}' in program memory", text),
                     "a function or label of the image, or 0xPC" + did_you_mean(text, known));
}

}  // namespace puckloop::exec
