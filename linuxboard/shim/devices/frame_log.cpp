#include "linuxboard/shim/devices/frame_log.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace puckloop::linuxboard {

namespace {
std::string fourcc_text(std::uint32_t fourcc) {
    std::string text(sizeof fourcc, ' ');
    for (std::size_t i = 0; i < sizeof fourcc; ++i)
        text[i] = static_cast<char>(fourcc >> (8 * i) & 0x7f);
    return text;
}

/// Those of an earlier run, by their names.
void remove_pictures(const std::filesystem::path& folder) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        const bool ours = name.size() == 12 && name.ends_with(".ppm") &&
                          name.find_first_not_of("0123456789") == name.size() - 4;
        if (ours) std::filesystem::remove(entry.path(), ignored);
    }
}
}  // namespace

FrameLog::FrameLog(const std::string& csv, std::string folder, std::uint32_t every)
    : folder_(std::move(folder)), every_(every) {
    if (!folder_.empty()) remove_pictures(folder_);
    if (csv.empty()) return;
    if (is_refused_link(csv))
        throw InputError(csv, "", why_not_written(ELOOP), "a folder of its own for the results");
    csv_.open(csv);
    if (!csv_) throw InputError(csv, "", std::strerror(errno), "a file that can be written");
    csv_ << "t_s,frame,sequence,width,height,format,hash\n";
}

void FrameLog::add(const Frame& frame, std::span<const std::uint8_t> bytes,
                   std::span<const std::uint8_t> rgb) {
    const std::uint64_t hash = frame_hash(bytes);
    const std::array<std::uint64_t, 2> both{hash_, hash};
    hash_ = frame_hash({reinterpret_cast<const std::uint8_t*>(both.data()), sizeof both});
    if (csv_.is_open())
        csv_ << fmt::format("{:.6f},{},{},{},{},{},{:016x}\n", cosim::to_seconds(frame.instant), frame.number,
                            frame.sequence, frame.size.width, frame.size.height,
                            fourcc_text(frame.format->fourcc), hash)
             << std::flush;
    if (!folder_.empty() && frames_ % every_ == 0) save(frame, rgb);
    ++frames_;
}

void FrameLog::save(const Frame& frame, std::span<const std::uint8_t> rgb) const {
    std::error_code ignored;
    std::filesystem::create_directories(folder_, ignored);
    const std::string file = fmt::format("{}/{:08d}.ppm", folder_, frame.number);
    make_new_file(file);
    std::ofstream out(file, std::ios::binary);
    out << fmt::format("P6\n{} {}\n255\n", frame.size.width, frame.size.height);
    out.write(reinterpret_cast<const char*>(rgb.data()), static_cast<std::streamsize>(rgb.size()));
    if (!out) throw RunError(file + ": the picture cannot be written");
}

}  // namespace puckloop::linuxboard
