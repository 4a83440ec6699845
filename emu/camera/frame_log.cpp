#include "emu/camera/frame_log.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

namespace puckloop::camera {

namespace {
void close(std::ofstream& out, const std::string& file) {
    out.flush();
    if (!out) throw RunError(fmt::format("{}: cannot be written", file));
}
}  // namespace

std::string report_json(const Camera& camera) {
    std::string text =
        fmt::format(R"({{"model": "{}", "pictures": {})", name_of(camera.model()), camera.frames().size());
    if (!camera.frames().empty()) {
        const TakenFrame& last = camera.frames().back();
        text += fmt::format(R"(, "last": {{"format": "{}", "step": {}, "hash": "{:016x}"}})",
                            name_of(last.format), last.step, last.hash);
    }
    return text + "}";
}

void write_frame_log(const std::string& file, const Camera& camera, const cosim::ClockDomain& clock) {
    make_new_file(file);
    std::ofstream out(file);
    out << "time_s,frame,format,step,column,row,hash,gain\n";
    for (const TakenFrame& frame : camera.frames()) {
        const cosim::Time time = clock.time_of(frame.cycle);
        out << fmt::format("{}.{:09},{},{},{},{},{},{:016x},{:.4f}\n", time / cosim::kSecond,
                           time % cosim::kSecond / cosim::kNanosecond, frame.frame, name_of(frame.format),
                           frame.step, frame.column, frame.row, frame.hash, frame.gain);
    }
    close(out, file);
    const Camera::Picture& seen = camera.last_picture();
    if (seen.rgb.empty()) return;
    const std::string picture = std::filesystem::path(file).replace_extension(".ppm").string();
    make_new_file(picture);
    std::ofstream pixels(picture, std::ios::binary);
    pixels << fmt::format("P6\n{} {}\n255\n", seen.width, seen.height);
    pixels.write(reinterpret_cast<const char*>(seen.rgb.data()),
                 static_cast<std::streamsize>(seen.rgb.size()));
    close(pixels, picture);
}

}  // namespace puckloop::camera
