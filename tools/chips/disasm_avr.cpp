#include "tools/chips/disasm_avr.h"

#include "base/error.h"
#include "emu/avr/assembler/listing.h"
#include "emu/avr/isa/isa.h"
#include "emu/image/avr_image.h"

#include <fmt/format.h>

#include <charconv>

namespace puckloop::tools {

namespace {

std::uint32_t address(const std::string& text, const char* option, const avr::DeviceInfo& device,
                      const image::AvrImage* image) {
    if (image)
        if (const auto found = image->find_code(text)) return *found;
    const auto value = hexadecimal(text, device.flash_bytes() - 1);
    if (!value)
        throw InputError("", option, fmt::format("\"{}\" is no program address", text),
                         fmt::format("0 to 0x{:X}{}", device.flash_bytes() - 1,
                                     image && !image->symbols.empty() ? " or a symbol of the image" : ""));
    return *value;
}

std::string list_words(const DisasmAvr& what, const avr::DeviceInfo& device) {
    image::ByteSegment segment{address(what.start, "--start", device, nullptr) & ~1u, {}};
    for (const std::string& text : what.words) {
        const auto word = hexadecimal(text, 0xFFFF);
        if (!word)
            throw InputError("", "--words", fmt::format("\"{}\" is no word", text),
                             "0 to 0xFFFF, hexadecimal");
        segment.bytes.push_back(static_cast<std::uint8_t>(*word));
        segment.bytes.push_back(static_cast<std::uint8_t>(*word >> 8));
    }
    return avr::list_program({segment});
}

}  // namespace

std::optional<std::uint32_t> hexadecimal(std::string_view text, std::uint32_t largest) {
    if (text.starts_with("0x") || text.starts_with("0X")) text.remove_prefix(2);
    std::uint32_t value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    if (error != std::errc{} || stop != text.data() + text.size() || value > largest) return std::nullopt;
    return value;
}

std::string disassemble_avr(const DisasmAvr& what, const avr::DeviceInfo& device) {
    if (!what.words.empty()) return list_words(what, device);
    const image::AvrImage image = image::load_avr_image(what.image, device.image_part());
    avr::ListingOptions options;
    options.start = address(what.start, "--start", device, &image);
    if (!what.end.empty()) options.end = address(what.end, "--end", device, &image);
    if (options.end < options.start)
        throw InputError("", "--end",
                         fmt::format("0x{:x} lies before --start 0x{:x}", options.end, options.start));
    for (const auto& [name, symbol] : image.symbols)
        if (symbol.space == image::Space::Program) options.labels.emplace(symbol.address, name);
    const std::string listing = avr::list_program(image.flash, options);
    if (listing.empty())
        throw InputError(what.image, "",
                         fmt::format("holds no bytes from 0x{:x} to 0x{:x}", options.start, options.end));
    std::size_t bytes = 0;
    for (const image::ByteSegment& segment : image.flash)
        bytes += segment.bytes.size();
    return fmt::format("; {}: {}, {} program bytes, sha256 {}\n", image.file, name_of(image.format), bytes,
                       image.sha256) +
           listing;
}

}  // namespace puckloop::tools
