// `puckloop mcp`: a server of the Model Context Protocol (docs/mcp.md). It is part of the Python client,
// which takes the place of this process: from share/puckloop or the sources, or else where Debian's python3
// finds it.

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "tools/cli/command.h"
#include "tools/commands.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <unistd.h>

namespace puckloop::tools {

namespace {

void become_server(const std::vector<std::string>& folders) {
    std::error_code failed;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", failed);
    if (!failed) ::setenv("PUCKLOOP", self.c_str(), 1);
    if (const auto client = shipped_file("clients/python"); !client.empty()) {
        const char* before = std::getenv("PYTHONPATH");
        const std::string path = before != nullptr && *before != '\0'
                                     ? fmt::format("{}:{}", client.string(), before)
                                     : client.string();
        ::setenv("PYTHONPATH", path.c_str(), 1);
    }
    std::vector<std::string> words{"python3", "-m", "puckloop.mcp"};
    for (const std::string& folder : folders) {
        words.emplace_back("--folder");
        words.push_back(folder);
    }
    std::vector<char*> pointers;
    for (std::string& word : words)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);
    ::execvp(pointers[0], pointers.data());
    throw InputError("mcp", "python3", std::strerror(errno), "Debian's package python3");
}

}  // namespace

void declare_mcp(Command& app, int& status) {
    auto folders = std::make_shared<std::vector<std::string>>();
    Command* command =
        app.add_subcommand("mcp", "server of the Model Context Protocol on standard input and output");
    command
        ->add_option("--folder", *folders,
                     "folder of which files may be named; results go into out/mcp of the first (default: the "
                     "current one; repeatable)")
        ->type_name("DIR");
    command->footer(
        "It serves a client that drives runs with tools such as start_run, step and read (docs/mcp.md).");
    command->callback([folders, &status] {
        become_server(*folders);
        status = 2;
    });
}

}  // namespace puckloop::tools
