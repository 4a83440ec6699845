#pragma once
// Opens a page in the user's browser.

#include <filesystem>
#include <string>

namespace puckloop::tools {

/// The address has a secret in it, and any user of the machine sees what a process was started with: the
/// browser gets a file, in a folder that only this user may enter, which leads on to the address.
class OpenedPage {
  public:
    /// Nothing is opened without a display, or without xdg-open: the address was printed anyway.
    explicit OpenedPage(const std::string& address);
    /// Removes the file.
    ~OpenedPage();
    OpenedPage(const OpenedPage&) = delete;
    OpenedPage& operator=(const OpenedPage&) = delete;

  private:
    std::filesystem::path folder_;
};

}  // namespace puckloop::tools
