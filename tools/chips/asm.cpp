// puckloop asm: dsPIC or AVR assembler source to Intel HEX or to a listing.

#include "base/error.h"
#include "emu/avr/assembler/assembler.h"
#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/devices/device.h"
#include "emu/image/intel_hex.h"
#include "tools/chips/chips.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/files/text_files.h"

#include <fmt/format.h>

#include <cstdio>
#include <memory>

namespace puckloop::tools {

namespace {

struct AsmArguments {
    std::string file;
    std::string output = "-";
    std::string format = "hex";
    std::string mcu = "dspic30f6014a";
};

std::string listing(const dspic::Program& program) {
    std::string text;
    for (const dspic::AssembledLine& line : program.lines) {
        std::string words;
        for (int i = 0; i < line.words && i < 2; ++i)
            words +=
                fmt::format(" {:06x}", program.words.at(line.address + 2 * static_cast<std::uint32_t>(i)));
        text += fmt::format("{:06x}:{:<15} {:>5}  {}\n", line.address, words, line.line, line.text);
    }
    return text;
}

std::string listing(const avr::Program& program) {
    std::string text;
    for (const avr::AssembledLine& line : program.lines) {
        std::string bytes;
        for (int i = 0; i < line.bytes && i < 4; ++i)
            bytes += fmt::format(" {:02x}", program.bytes.at(line.address + static_cast<std::uint32_t>(i)));
        text += fmt::format("{:05x}:{:<13} {:>5}  {}\n", line.address, bytes, line.line, line.text);
    }
    return text;
}

/// Code of a dsPIC between the reset vector and the end of the vector tables is never executed: a trap
/// (DS70046, 6.2). Warns of its first line.
void warn_of_code_in_vectors(const dspic::Program& program, const std::string& file) {
    constexpr std::uint32_t kFirstVector = 0x4, kAfterVectors = 0x100;
    for (const dspic::AssembledLine& line : program.lines) {
        if (line.address < kFirstVector || line.address >= kAfterVectors) continue;
        const std::string code = line.text.substr(line.text.find(':') + 1);  // 0 without a label
        const std::size_t begin = code.find_first_not_of(" \t");
        if (begin == std::string::npos || code[begin] == '.') continue;
        fmt::print(
            stderr,
            "puckloop: warning: {}: line {}: code at {:06x}, where the vectors are: an address error trap "
            "(expected goto start at 0 and .org 0x100 before it)\n",
            file, line.line, line.address);
        return;
    }
}

std::string assemble_dspic(const AsmArguments& arguments, const std::string& file,
                           const dspic::DeviceInfo& device) {
    dspic::AssembleOptions options;
    options.file = file;
    options.keep_lines = true;
    for (const dspic::RegisterInfo& info : device.registers)
        options.predefined[std::string(info.name)] = info.address;
    const dspic::Program program = dspic::assemble(read_text(arguments.file), options);
    if (program.words.empty()) throw InputError(file, "", "yields no program words", "instructions");
    if (arguments.format == "list") return listing(program);
    warn_of_code_in_vectors(program, file);
    return image::write_dspic_hex(program.words);
}

std::string assemble_avr(const AsmArguments& arguments, const std::string& file,
                         const avr::DeviceInfo& device) {
    const bool list = arguments.format == "list";
    const avr::Program program = avr::assemble(read_text(arguments.file), {file, &device, list});
    if (program.bytes.empty()) throw InputError(file, "", "yields no program words", "instructions");
    if (list) return listing(program);
    image::ByteSegments segments(file);
    for (const auto& [address, byte] : program.bytes)
        segments.add(address, {byte}, "");
    return image::write_intel_hex(segments.joined());
}

void run_asm(const AsmArguments& arguments) {
    const std::string file = arguments.file == "-" ? "stdin" : arguments.file;
    if (const dspic::DeviceInfo* device = dspic::find_device(arguments.mcu))
        write_text(arguments.output, assemble_dspic(arguments, file, *device));
    else if (const avr::DeviceInfo* part = avr::find_device(arguments.mcu))
        write_text(arguments.output, assemble_avr(arguments, file, *part));
    else
        throw InputError("", "--mcu", fmt::format("unknown chip \"{}\"", arguments.mcu),
                         dspic::device_names() + ", " + avr::device_names());
}

}  // namespace

void declare_asm(Command& app, int& status) {
    auto arguments = std::make_shared<AsmArguments>();
    Command* command = app.add_subcommand("asm", about("asm"));
    command->add_option("FILE", arguments->file, "source file, - for standard input")
        ->required()
        ->type_name("FILE");
    command->add_option("-o,--output", arguments->output, "output file; standard output without it")
        ->type_name("FILE");
    command
        ->add_option("--format", arguments->format,
                     "hex: Intel HEX; list: addresses and words beside the source")
        ->check(one_of({"hex", "list"}))
        ->capture_default_str();
    command->add_option("--mcu", arguments->mcu, "chip to assemble for; its register names are known")
        ->type_name("CHIP")
        ->capture_default_str();
    command->footer("Syntax of a dsPIC source (instructions as XC16 writes them):\n"
                    "          goto  start                    ; the reset vector, at 0\n"
                    "          .org  0x100                    ; behind the vectors\n"
                    "  start:  mov   #0x10, w0                ; a label; // begins a comment as well\n"
                    "          mov   w0, TRISD                ; registers by their data-sheet names\n"
                    "          .equ  SIZE, 4*8                ; or SIZE = 4*8\n"
                    "  table:  .word 0x1234, start            ; .pword 0x123456, .ascii \"ab\", .asciz, "
                    ".pfill 100, 0xffffff\n"
                    "          .include \"other.s\"            ; .text and .global pass, .end ends\n"
                    "An AVR source is as for GNU as, with .word, .byte, .balign, lo8() and hi8().\n"
                    "Examples:\n"
                    "  puckloop asm blink.s -o blink.hex && puckloop exec blink.hex\n"
                    "  puckloop asm blink.s --format list\n"
                    "  puckloop asm blink.s --mcu atmega1284p -o blink.hex");
    command->callback([arguments, &status] {
        run_asm(*arguments);
        status = 0;
    });
}

}  // namespace puckloop::tools
