#include "tools/viewer/browser.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <system_error>

namespace puckloop::tools {

namespace {

bool has_display() {
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
        if (const char* value = std::getenv(name); value != nullptr && *value != '\0') return true;
    return false;
}

}  // namespace

OpenedPage::OpenedPage(const std::string& address) {
    if (!has_display()) return;
    std::string name = (std::filesystem::temp_directory_path() / "puckloop-page-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) return;
    folder_ = name;
    const std::string file = (folder_ / "page.html").string();
    std::ofstream(file) << "<!DOCTYPE html><meta http-equiv=\"refresh\" content=\"0;url=" << address
                        << "\"><a href=\"" << address << "\">the run</a>\n";
    std::string program = "xdg-open", argument = file;
    char* words[] = {program.data(), argument.data(), nullptr};
    pid_t child = 0;
    // It leaves as soon as a browser has taken the file over.
    if (::posix_spawnp(&child, "xdg-open", nullptr, nullptr, words, environ) == 0)
        ::waitpid(child, nullptr, 0);
}

OpenedPage::~OpenedPage() {
    std::error_code ignored;
    if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

}  // namespace puckloop::tools
