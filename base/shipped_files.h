#pragma once
// Files that come with the program: scenarios, campaigns, firmware images.

#include <filesystem>
#include <string_view>

namespace puckloop {

/// `name` ("scenarios/hello.toml", "firmware/epuck") where this program is installed
/// (PREFIX/share/puckloop) or, in a build, in its sources; empty where it is in neither.
std::filesystem::path shipped_file(std::string_view name);

/// A shipped firmware image by the name of its file ("epuck_ircom.hex", "tam.elf"); empty: there is none.
std::filesystem::path shipped_image(std::string_view file_name);

}  // namespace puckloop
