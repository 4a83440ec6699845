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

/// Around a program of the Linux board.
std::vector<NewFile> controller_files(std::string_view name);

/// Around a firmware of the main board, which is the shipped one of firmware/start. Throws RunError: it is
/// not installed.
std::vector<NewFile> firmware_files(std::string_view name);

/// CI, editor settings and the schema; `image` is what a debugger begins with.
void add_shared_files(std::vector<NewFile>& files, std::string_view name, std::string_view image);

/// `text` with the project's name in place of each NAME.
std::string named(std::string_view text, std::string_view name);

}  // namespace puckloop::tools
