// Reading a file, recognising its format by content, and looking symbols up.

#include "base/error.h"
#include "emu/image/coff.h"
#include "emu/image/dspic_view.h"
#include "emu/image/elf.h"
#include "emu/image/image.h"
#include "emu/image/intel_hex.h"

#include <fmt/format.h>
#include <nettle/sha2.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace puckloop::image {

namespace {

constexpr std::uintmax_t kLargestFile = 64u
                                        << 20;  // thirteen times the largest real image seen, with debug data

std::string read_file(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InputError(path, "", "no such file", "a HEX, ELF or COFF image");
    if (fs::is_directory(status)) throw InputError(path, "", "is a directory", "a HEX, ELF or COFF image");
    if (!fs::is_regular_file(status))
        throw InputError(path, "", "is not a regular file", "a HEX, ELF or COFF image");
    const std::uintmax_t size = fs::file_size(path, error);
    if (!error && size > kLargestFile)
        throw InputError(path, "", fmt::format("is {} bytes large", size), "an image of at most 64 MB");
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw InputError(path, "", fmt::format("cannot be opened: {}", std::strerror(errno)));
    std::string bytes{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (stream.bad()) throw InputError(path, "", "cannot be read");
    return bytes;
}

std::string sha256_of(std::string_view bytes) {
    sha256_ctx context;
    sha256_init(&context);
    sha256_update(&context, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
    std::uint8_t digest[SHA256_DIGEST_SIZE];
    sha256_digest(&context, sizeof digest, digest);
    std::string text;
    for (const std::uint8_t byte : digest)
        fmt::format_to(std::back_inserter(text), "{:02x}", byte);
    return text;
}

bool looks_like_hex(std::string_view bytes) {
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && bytes[first] == ':';
}

}  // namespace

const char* name_of(Format format) {
    switch (format) {
    case Format::IntelHex:
        return "Intel HEX";
    case Format::Elf:
        return "ELF";
    case Format::Coff:
        return "COFF";
    }
    return "?";
}

std::optional<std::uint32_t> Image::find_code(std::string_view name) const {
    for (const std::string& spelling : {std::string(name), "_" + std::string(name)}) {
        const auto found = symbols.find(spelling);
        if (found != symbols.end() && found->second.space == Space::Program) return found->second.address;
    }
    return std::nullopt;
}

Words Image::all_words() const {
    Words all = program;
    for (const Words* more : {&eeprom, &config, &other})
        all.insert(more->begin(), more->end());
    return all;
}

Image parse_image(std::string_view bytes, const std::string& file) {
    Image image;
    image.file = file;
    image.sha256 = sha256_of(bytes);
    if (bytes.empty()) throw InputError(file, "", "is empty", "a HEX, ELF or COFF image");
    if (is_elf(bytes)) {
        image.format = Format::Elf;
        read_elf(bytes, image);
    } else if (is_coff(bytes)) {
        image.format = Format::Coff;
        read_coff(bytes, image);
    } else if (looks_like_hex(bytes)) {
        image.format = Format::IntelHex;
        add_words(image, parse_intel_hex(bytes, file));
    } else {
        throw InputError(file, "offset 0x0", "is in no known image format",
                         "Intel HEX (':' first), ELF32 of XC16, or COFF of C30");
    }
    if (image.program.empty()) throw InputError(file, "", "holds no program words", "firmware");
    return image;
}

Image load_image(const std::string& path) {
    return parse_image(read_file(path), path);
}

}  // namespace puckloop::image
