// puckloop disasm: a firmware image, or a few words, as dsPIC or AVR assembler source.

#include "base/error.h"
#include "emu/dspic/assembler/disassembler.h"
#include "emu/dspic/assembler/listing.h"
#include "emu/dspic/devices/device.h"
#include "emu/image/image.h"
#include "tools/chips/chips.h"
#include "tools/chips/disasm_avr.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/files/scenario_name.h"
#include "tools/files/text_files.h"

#include <fmt/format.h>

#include <memory>

namespace puckloop::tools {

namespace {

constexpr std::uint32_t kLargestAddress = 0xFFFFFF;
constexpr std::uint32_t kLargestWord = 0xFFFFFF;
constexpr std::uint32_t kVectorsEnd30F = 0x100;
constexpr std::uint32_t kVectorsEnd33F = 0x200;

struct DisasmArguments {
    std::string image;
    std::string start = "0";
    std::string end;  ///< empty: the last program address
    std::vector<std::string> words;
    std::string mcu = "dspic30f6014a";
};

/// A hexadecimal program address, or a symbol of the image.
std::uint32_t address(const std::string& text, const char* option, const image::Image* image) {
    if (image)
        if (const auto found = image->find_code(text)) return *found;
    const auto value = hexadecimal(text, kLargestAddress);
    if (!value)
        throw InputError("", option, fmt::format("\"{}\" is no program address", text),
                         image && !image->symbols.empty() ? "0 to 0xFFFFFF or a symbol of the image"
                                                          : "0 to 0xFFFFFF");
    return *value & ~1u;
}

std::string list_words(const DisasmArguments& arguments) {
    std::vector<std::uint32_t> words;
    for (const std::string& text : arguments.words) {
        const auto word = hexadecimal(text, kLargestWord);
        if (!word)
            throw InputError("", "--words", fmt::format("\"{}\" is no word", text),
                             "0 to 0xFFFFFF, hexadecimal");
        words.push_back(*word);
    }
    std::uint32_t at = address(arguments.start, "--start", nullptr);
    std::string output;
    for (std::size_t i = 0; i < words.size();) {
        const std::uint32_t next =
            i + 1 < words.size() ? words[i + 1] : 0xFFFFFF;  // a pair cut short is no pair
        dspic::InstructionText text;
        const int length = dspic::disassemble(words[i], next, at, text);
        std::string comment = fmt::format("; {:06x}: {:06x}", at, words[i]);
        if (length == 2) comment += fmt::format(" {:06x}", next);
        output += fmt::format("{:<40}{}\n", text.view(), comment);
        i += static_cast<std::size_t>(length);
        at += 2 * static_cast<std::uint32_t>(length);
    }
    return output;
}

std::string list_image(const DisasmArguments& arguments) {
    const image::Image image = image::load_image(arguments.image);
    dspic::ListingOptions options;
    options.start = address(arguments.start, "--start", &image);
    options.end = arguments.end.empty() ? kLargestAddress : address(arguments.end, "--end", &image);
    if (options.end < options.start)
        throw InputError("", "--end",
                         fmt::format("{:#x} lies before --start {:#x}", options.end, options.start));
    for (const auto& [name, symbol] : image.symbols)
        if (symbol.space == image::Space::Program) options.labels.emplace(symbol.address, name);
    // Interrupt vectors of the 33F reach to 0x1FF; those of the 30F leave the words at 0x80 and 0x82 alone.
    const auto after_30f = image.program.find(0x80);
    const bool is_33f = after_30f != image.program.end() && after_30f->second != 0xFFFFFF;
    options.vectors_end = is_33f ? kVectorsEnd33F : kVectorsEnd30F;
    const image::Words words = image.all_words();
    if (words.lower_bound(options.start) == words.upper_bound(options.end))
        throw InputError(arguments.image, "",
                         fmt::format("holds no words from {:#x} to {:#x}", options.start, options.end));
    return fmt::format("; {}: {}, {} program words, sha256 {}\n", arguments.image, name_of(image.format),
                       image.program.size(), image.sha256) +
           dspic::list_program(words, options);
}

std::string list(const DisasmArguments& arguments) {
    if (const avr::DeviceInfo* part = avr::find_device(arguments.mcu))
        return disassemble_avr({arguments.image, arguments.start, arguments.end, arguments.words}, *part);
    if (!dspic::find_device(arguments.mcu))
        throw InputError("", "--mcu", fmt::format("unknown chip \"{}\"", arguments.mcu),
                         dspic::device_names() + ", " + avr::device_names());
    return arguments.words.empty() ? list_image(arguments) : list_words(arguments);
}

}  // namespace

void declare_disasm(Command& app, int& status) {
    auto arguments = std::make_shared<DisasmArguments>();
    Command* command = app.add_subcommand("disasm", about("disasm"));
    Option* image = command->add_option("IMAGE", arguments->image, "HEX, ELF or COFF image");
    command->add_option("--start", arguments->start, "first program address, hexadecimal or a symbol");
    command->add_option("--end", arguments->end, "last program address, hexadecimal or a symbol");
    command->add_option("--words", arguments->words, "words in hexadecimal instead of an image")
        ->delimiter(',')
        ->excludes(image);
    command->add_option("--mcu", arguments->mcu, "the chip; the dsPICs read alike")->capture_default_str();
    command->callback([arguments, &status] {
        if (arguments->image.empty() && arguments->words.empty())
            throw InputError("", "disasm", "nothing to disassemble", "an image or --words 0x...");
        arguments->image = image_named(arguments->image);
        write_text("-", list(*arguments));
        status = 0;
    });
}

}  // namespace puckloop::tools
