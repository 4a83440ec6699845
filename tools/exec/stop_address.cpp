// `--stop-at SYMBOL|0xPC`.

#include "base/error.h"
#include "tools/exec/options.h"

#include <fmt/format.h>

#include <charconv>

namespace puckloop::exec {

namespace {
constexpr std::uint32_t kHighestProgramAddress = 0x7FFFFE;
}

StopAddress resolve_stop(const std::string& text, const image::Image& image) {
    if (text.starts_with("0x") || text.starts_with("0X")) {
        std::uint32_t pc = 0;
        const char* const last = text.data() + text.size();
        const auto [end, error] = std::from_chars(text.data() + 2, last, pc, 16);
        if (error != std::errc{} || end != last || text.size() == 2 || pc > kHighestProgramAddress ||
            pc % 2 != 0)
            throw InputError("", "--stop-at", fmt::format("'{}' is not a program address", text),
                             "an even one, such as 0x1f48");
        return {pc, text};
    }
    if (const auto pc = image.find_code(text)) return {*pc, text};
    if (image.symbols.empty())
        throw InputError(image.file, "--stop-at",
                         fmt::format("the image has no symbols, so '{}' is unknown", text),
                         "0xPC, or an ELF or COFF image");
    throw InputError(image.file, "--stop-at", fmt::format("no symbol '{}' in program memory", text),
                     "a function or label of the image, or 0xPC");
}

}  // namespace puckloop::exec
