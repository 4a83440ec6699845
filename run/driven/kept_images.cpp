#include "run/driven/kept_images.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/sha256.h"
#include "emu/avr/devices/device.h"
#include "emu/dspic/devices/device.h"
#include "emu/image/avr_image.h"
#include "emu/image/device.h"
#include "emu/image/image.h"
#include "emu/image/image_file.h"
#include "run/description/main_board.h"

#include <utility>
#include <variant>

namespace puckloop::tools {

namespace fs = std::filesystem;

namespace {
constexpr std::size_t kHashDigits = 12;  // of the hash, before a copy's name
}

KeptImages::KeptImages(fs::path folder) : folder_(std::move(folder)) {}

void KeptImages::remember(const std::string& file) {
    if (!remembered_.insert(file).second) return;
    if (auto bytes = read_whole_file(file)) bytes_.emplace(file, std::move(*bytes));
}

std::string KeptImages::as_it_was(const std::string& file) const {
    const auto kept = bytes_.find(file);
    if (kept == bytes_.end() || read_whole_file(file) == kept->second) return file;
    return written(file, kept->second);
}

void remove_kept_images(const fs::path& folder) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none)) {
        const std::string name = entry.path().filename().string();
        const bool copy = name.size() > kHashDigits && name[kHashDigits] == '-' &&
                          name.find_first_not_of("0123456789abcdef") == kHashDigits;
        if (copy && entry.is_regular_file(none)) fs::remove(entry.path(), none);
    }
    fs::remove(folder, none);  // stays where there is something else
}

/// The name begins with the hash, so that images of one name do not meet; what a fault's words cannot hold is
/// left out of it.
std::string KeptImages::written(const std::string& file, const std::string& bytes) const {
    constexpr std::size_t kLongestName = 100;
    std::string name;
    for (const char c : fs::path(file).filename().string())
        if ((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' ||
            c == '-' || c == '_')
            name += c;
    if (name.size() > kLongestName) name.erase(0, name.size() - kLongestName);
    make_folder(folder_);
    const fs::path copy = fs::absolute(folder_ / (sha256_text(bytes).substr(0, kHashDigits) + "-" + name));
    if (read_whole_file(copy) != bytes) write_file(copy, bytes);
    return copy.string();
}

KeptImages::Copy KeptImages::copy(const NodeDescription& board, const std::string& file) const {
    const std::string bytes = image::read_image_file(file);
    if (std::holds_alternative<tam::TamSpec>(board.kind)) {
        image::parse_avr_image(bytes, file, avr::atmega1284p().image_part());
    } else {
        const bool main = std::holds_alternative<MainBoard>(board.kind);
        const auto& device = main ? dspic::dspic30f6014a() : dspic::dspic33fj256gp710();
        image::check_fits(image::parse_image(bytes, file), image::find_device(device.name));
    }
    return {written(file, bytes), sha256_text(bytes)};
}

}  // namespace puckloop::tools
