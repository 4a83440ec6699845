// Reading a file, recognising its format by content, and looking symbols up.

#include "base/error.h"
#include "base/logs/log.h"
#include "base/sha256.h"
#include "emu/image/coff.h"
#include "emu/image/dspic_view.h"
#include "emu/image/elf.h"
#include "emu/image/elf_file.h"
#include "emu/image/image.h"
#include "emu/image/image_file.h"
#include "emu/image/image_hash.h"
#include "emu/image/intel_hex.h"

#include <deque>
#include <memory>
#include <mutex>
#include <utility>

namespace puckloop::image {

namespace {

/// What this process parsed last, by content: twenty boards of a run load one file several times each, and
/// to parse it takes ten times as long as to read and hash it.
class Parsed {
  public:
    std::shared_ptr<const Image> find(const std::string& sha256) {
        const std::lock_guard lock(mutex_);
        for (const auto& image : images_)
            if (image->sha256 == sha256) return image;
        return nullptr;
    }
    void keep(std::shared_ptr<const Image> image) {
        const std::lock_guard lock(mutex_);
        images_.push_back(std::move(image));
        if (images_.size() > kMost) images_.pop_front();
    }

  private:
    static constexpr std::size_t kMost = 8;
    std::mutex mutex_;
    std::deque<std::shared_ptr<const Image>> images_;
};

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
    image.sha256 = sha256_text(bytes);
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

void check_hash(const std::string& file, const std::string& sha256, const std::string& expected) {
    if (!expected.empty() && sha256 != expected)
        throw InputError(file, "", "is another image than the one that was flashed, its SHA-256 is " + sha256,
                         expected);
}

Image load_image(const std::string& path) {
    static Parsed parsed;
    const std::string bytes = read_image_file(path);
    auto known = parsed.find(sha256_text(bytes));
    if (!known) parsed.keep(known = std::make_shared<const Image>(parse_image(bytes, path)));
    Image image = *known;
    image.file = path;
    log::info("read {}: {}, {} program words, {} symbols, sha256 {}", path, name_of(image.format),
              image.program.size(), image.symbols.size(), image.sha256);
    return image;
}

}  // namespace puckloop::image
