#include "benchmark/scenarios/scenario_file.h"

#include "base/files/text_file.h"

namespace puckloop::tools {

std::filesystem::path write_scenario(const std::filesystem::path& folder, const std::string& name,
                                     const std::string& text) {
    make_folder(folder);
    const std::filesystem::path file = folder / (name + ".toml");
    write_file(file, text);
    return file;
}

}  // namespace puckloop::tools
