#include "emu/board/nvm_file.h"

#include "base/error.h"
#include "base/sha256.h"
#include "emu/image/image_file.h"
#include "emu/image/intel_hex.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace puckloop::board {

namespace {

constexpr std::string_view kTitle = "puckloop non-volatile memory 1";
constexpr mode_t kMode = 0666;
constexpr std::size_t kShownOfStateHash = 12;
constexpr std::string_view kAsWritten =
    "the file as a run left it, or none: then the board begins with its image";

/// Takes the first line off `text`; `key` must begin it.
std::string_view take_line(std::string_view& text, std::string_view key, int number,
                           const std::string& file) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    if (end == std::string_view::npos || !line.starts_with(key))
        throw InputError(file, fmt::format("line {}", number),
                         number == 1 ? std::string("is no file of non-volatile memory")
                                     : fmt::format("is damaged: no '{}'", key.substr(0, key.size() - 2)),
                         kAsWritten);
    text.remove_prefix(end + 1);
    return line.substr(key.size());
}

bool exists(const std::string& path) {
    struct stat status {};
    return ::lstat(path.c_str(), &status) == 0;
}

}  // namespace

NvmFile::NvmFile(std::string path, std::string_view chip, const image::Image& begins_with)
    : path_(std::move(path)), part_(path_ + ".part"), chip_(chip), image_(begins_with.sha256) {
    take();
    if (!exists(path_)) return;
    try {
        const std::string bytes = image::read_image_file(path_);
        std::string_view rest = bytes;
        take_line(rest, kTitle, 1, path_);
        const std::string_view of_chip = take_line(rest, "chip: ", 2, path_);
        const std::string_view of_image = take_line(rest, "image: ", 3, path_);
        const std::string_view sum = take_line(rest, "contents: ", 4, path_);
        if (sha256_text(rest) != sum)
            throw InputError(path_, "", "is damaged: its contents do not match their checksum", kAsWritten);
        if (of_chip != chip_)
            throw InputError(path_, "line 2", fmt::format("is the memory of a {}", of_chip),
                             fmt::format("a file of this {}", chip_));
        if (of_image != image_)
            throw InputError(path_, "line 3",
                             fmt::format("began with another image than {} ({}..., not {}...)",
                                         begins_with.file, of_image.substr(0, kShownOfStateHash),
                                         image_.substr(0, kShownOfStateHash)),
                             "that image; or remove the file, and the board begins with this one");
        contents_ = std::string(rest);
    } catch (...) {
        ::close(descriptor_);
        ::unlink(part_.c_str());
        throw;
    }
}

NvmFile::~NvmFile() {
    if (descriptor_ < 0) return;
    ::unlink(part_.c_str());
    ::close(descriptor_);
}

/// The file to be is made now: a place that cannot be written, and a second user, show before the run.
void NvmFile::take() {
    descriptor_ = ::open(part_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, kMode);
    if (descriptor_ < 0)
        throw InputError(path_, "", fmt::format("cannot be written: {}", std::strerror(errno)),
                         "a place in a folder that exists and may be written");
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
    ::close(descriptor_);
    throw InputError(path_, "", "is in use by another board or run", "a file of its own for each board");
}

image::Image NvmFile::over(image::Image image) const {
    if (!contents_) return image;
    const image::Image kept = image::parse_image(*contents_, path_);
    image.program = kept.program;
    image.eeprom = kept.eeprom;
    image.config = kept.config;
    image.other = kept.other;
    return image;
}

void NvmFile::save(const image::Words& words) {
    save_contents(image::write_dspic_hex(words));
}

void NvmFile::save_contents(const std::string& contents) {
    const std::string text = fmt::format("{}\nchip: {}\nimage: {}\ncontents: {}\n{}", kTitle, chip_, image_,
                                         sha256_text(contents), contents);
    const auto require = [&](bool done) {
        if (!done)
            throw RunError(
                fmt::format("{}: cannot be written: {}; it is as it was", path_, std::strerror(errno)));
    };
    require(::ftruncate(descriptor_, 0) == 0);
    for (std::string_view rest = text; !rest.empty();) {
        const ssize_t written =
            ::pwrite(descriptor_, rest.data(), rest.size(), static_cast<off_t>(text.size() - rest.size()));
        if (written < 0 && errno == EINTR) continue;
        require(written >= 0);
        rest.remove_prefix(static_cast<std::size_t>(written));
    }
    require(::fsync(descriptor_) == 0);
    require(::rename(part_.c_str(), path_.c_str()) == 0);
    ::close(descriptor_);
    descriptor_ = -1;
}

}  // namespace puckloop::board
