#include "tools/files/scenario_name.h"

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "emu/image/chip_guess.h"
#include "scenarios/values/image_key.h"

namespace puckloop::tools {

namespace {

std::filesystem::path shipped_in(const std::string& folder, const std::filesystem::path& given) {
    std::error_code error;
    if (given.empty() || std::filesystem::exists(given, error)) return given;
    // As help and documents write it, or by its name alone.
    const std::string whole = given.string(), start = whole.starts_with(folder) ? "" : folder;
    if (given.has_parent_path() && !start.empty()) return given;
    for (const char* ending : {"", ".toml"}) {
        const std::filesystem::path file = shipped_file(start + whole + ending);
        if (std::filesystem::is_regular_file(file, error)) return file;
    }
    return given;
}

}  // namespace

std::filesystem::path scenario_named(const std::filesystem::path& given) {
    std::error_code error;
    if (std::filesystem::is_regular_file(given, error) && image::looks_like_image(given.string()))
        throw InputError(given.string(), "", "is a firmware image, no scenario",
                         "puckloop exec IMAGE, or --firmware BOARD=IMAGE beside a scenario");
    return shipped_in("scenarios/", given);
}

std::string image_named(const std::string& given) {
    const std::filesystem::path there = given.empty() ? "" : scenarios::firmware_named({}, given, "");
    return there.empty() ? given : there.string();
}

std::filesystem::path mission_named(const std::filesystem::path& given) {
    const std::filesystem::path own = shipped_in("scenarios/missions/", given);
    return own == given ? scenario_named(given) : own;
}

std::filesystem::path campaign_named(const std::filesystem::path& given) {
    return shipped_in("campaigns/", given);
}

std::filesystem::path experiment_named(const std::filesystem::path& given) {
    return shipped_in("scenarios/experiments/", given);
}

}  // namespace puckloop::tools
