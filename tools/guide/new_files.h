#pragma once
// What `puckloop new NAME` writes.

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

struct NewFile {
    std::string path;  ///< within the new folder
    std::string text;
    bool program = false;  ///< may be executed
};

std::vector<NewFile> new_files(std::string_view name);

}  // namespace puckloop::tools
