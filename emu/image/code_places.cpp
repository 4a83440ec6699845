#include "emu/image/code_places.h"

#include "base/error.h"
#include "base/sha256.h"

#include "emu/image/image_file.h"

#include <utility>

namespace puckloop::image {

namespace {
LineTable lines_of(const std::string& file, const std::string& sha256) {
    if (file.empty()) return {};
    try {
        if (sha256_text(read_image_file(file)) != sha256) return {};
        return source_lines(file);
    } catch (const InputError&) {
        return {};
    }
}
}  // namespace

CodePlaces::CodePlaces(const std::map<std::string, Symbol>& symbols, std::string file, std::string sha256)
    : symbols_(symbols), file_(std::move(file)), sha256_(std::move(sha256)) {}

std::string CodePlaces::line(std::uint32_t address) const {
    if (!lines_) lines_ = lines_of(file_, sha256_);
    return lines_->at(address);
}

std::string CodePlaces::text(std::uint32_t address) const {
    const std::string name = symbol(address), source = line(address);
    return (name.empty() ? "" : " in " + name) + (source.empty() ? "" : " (" + source + ")");
}

}  // namespace puckloop::image
