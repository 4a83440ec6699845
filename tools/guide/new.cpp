// `puckloop new NAME`: a folder with a scenario, controllers, a test, CI files and editor settings.

#include "base/error.h"
#include "base/files/text_file.h"
#include "tools/cli/command.h"
#include "tools/guide/guide.h"
#include "tools/guide/project/new_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

/// The name is a folder's, a scenario's and, behind "test_", a Python module's.
void check_name(const std::string& name) {
    constexpr std::size_t kLongest = 64;
    const bool plain =
        !name.empty() && name.size() <= kLongest && std::all_of(name.begin(), name.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        });
    if (!plain)
        throw InputError("", "new", fmt::format("'{}' cannot be a project's name", name),
                         "at most 64 letters, digits and _, such as my_robot");
}

int make(const std::string& name, bool firmware) {
    check_name(name);
    const fs::path folder(name);
    std::error_code error;
    if (fs::exists(fs::symlink_status(folder, error)))
        throw InputError(name, "", "is there already", "a name that is free");
    for (const NewFile& file : firmware ? firmware_files(name) : controller_files(name)) {
        const fs::path path = folder / file.path;
        make_folder(path.parent_path());
        write_file(path, file.text);
        if (file.program)
            fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec,
                            fs::perm_options::add, error);
        fmt::print("{}\n", path.string());
    }
    fmt::print("Next: puckloop run {0}/{0}.toml --in-process (and {0}/README.md)\n", name);
    return 0;
}

}  // namespace

void declare_new(Command& app, int& status) {
    auto name = std::make_shared<std::string>();
    Command* command = app.add_subcommand("new", "a folder to begin with: scenario, controller in Python and "
                                                 "C or firmware, test, CI, editor settings");
    command->add_option("name", *name, "of the folder, which must not be there")
        ->required()
        ->type_name("NAME");
    auto firmware = std::make_shared<bool>(false);
    command->add_flag("--firmware", *firmware,
                      "around a firmware of the main board in place of a controller of the Linux board");
    command->footer("Examples:\n"
                    "  puckloop new my_robot\n"
                    "  puckloop new my_firmware --firmware");
    command->callback([name, firmware, &status] { status = make(*name, *firmware); });
}

}  // namespace puckloop::tools
