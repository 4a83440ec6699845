#include "tools/bench/scenario_file.h"

#include "base/error.h"

#include <fmt/format.h>

#include <fstream>

namespace puckloop::tools {

std::filesystem::path write_scenario(const std::filesystem::path& folder, const std::string& name,
                                     const std::string& text) {
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / (name + ".toml");
    std::ofstream out(file);
    out << text;
    out.close();
    if (!out) throw RunError(fmt::format("{}: cannot be written", file.string()));
    return file;
}

}  // namespace puckloop::tools
