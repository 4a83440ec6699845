#pragma once
// Files that come with the program: scenarios, campaigns, firmware images, programs that it starts. They are
// found from where the program is, so that a build and an installation can be moved.

#include <filesystem>
#include <string_view>

namespace puckloop {

/// `name` ("scenarios/hello.toml", "firmware/epuck") in the folder that PUCKLOOP_DATA names, where this
/// program is installed (PREFIX/share/puckloop), or, in a build, in the build or its sources; empty where it
/// is in none.
std::filesystem::path shipped_file(std::string_view name);

/// A program or library of the project beside this program, in PREFIX/lib/puckloop, or, in a build, in its
/// `build_folder` ("linuxboard/shim"); empty: there is none.
std::filesystem::path shipped_program(std::string_view file_name, std::string_view build_folder);

/// `puckloop` itself, from any of the project's programs: beside this one, or in PREFIX/bin; empty: it is not
/// there.
std::filesystem::path main_program();

/// A shipped firmware image by the name of its file ("epuck_ircom.hex", "tam.elf"); empty: there is none.
std::filesystem::path shipped_image(std::string_view file_name);

}  // namespace puckloop
