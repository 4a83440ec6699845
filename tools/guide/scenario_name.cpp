#include "tools/guide/scenario_name.h"

#include "base/error.h"
#include "base/shipped_files.h"
#include "emu/image/chip_guess.h"

namespace puckloop::tools {

std::filesystem::path scenario_named(const std::filesystem::path& given) {
    std::error_code error;
    if (std::filesystem::is_regular_file(given, error) && image::looks_like_image(given.string()))
        throw InputError(given.string(), "", "is a firmware image, no scenario",
                         "puckloop exec IMAGE, or --firmware BOARD=IMAGE beside a scenario");
    if (given.empty() || std::filesystem::exists(given, error) || given.has_parent_path()) return given;
    for (const char* ending : {"", ".toml"}) {
        const std::filesystem::path file = shipped_file("scenarios/" + given.string() + ending);
        if (std::filesystem::is_regular_file(file, error)) return file;
    }
    return given;
}

}  // namespace puckloop::tools
