#pragma once
// A browser without a window, for pictures of a page: Chromium or Chrome, if one is installed, driven over a
// pipe of its own by the DevTools protocol. It asks nobody for anything.

#include <nlohmann/json_fwd.hpp>

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace puckloop::tools {

class HeadlessBrowser {
  public:
    /// Starts it with a page of so many pixels. Throws InputError where none is installed, RunError where it
    /// does not start.
    HeadlessBrowser(int width, int height);
    /// Ends it, and removes what it left.
    ~HeadlessBrowser();
    HeadlessBrowser(const HeadlessBrowser&) = delete;
    HeadlessBrowser& operator=(const HeadlessBrowser&) = delete;

    void open(const std::string& address);
    /// Of JavaScript; promises are awaited. Throws RunError: it threw, or nothing came within kPatience.
    nlohmann::json value(const std::string& expression);
    /// What the page shows now, or the element with this id: "png" or "jpeg", its bytes.
    std::string picture(const std::string& format, const std::string& element);
    /// Its own: only this user may enter it, and it goes with it.
    const std::filesystem::path& folder() const { return folder_; }

    static constexpr int kPatienceMs = 60'000;

  private:
    nlohmann::json call(const std::string& method, const nlohmann::json& parameters);
    std::string message();
    void end();

    std::filesystem::path folder_;
    pid_t child_ = -1;
    int to_ = -1, from_ = -1, number_ = 0;
    std::string received_, session_;
};

}  // namespace puckloop::tools
