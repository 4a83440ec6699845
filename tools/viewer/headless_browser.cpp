#include "tools/viewer/headless_browser.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <system_error>
#include <vector>

namespace puckloop::tools {

namespace {

using nlohmann::json;

/// In PATH; empty: none.
std::string installed_browser() {
    const char* const path = std::getenv("PATH");
    const std::string folders = path != nullptr ? path : "/usr/bin:/bin";
    for (const char* name : {"chromium", "chromium-browser", "google-chrome", "google-chrome-stable"})
        for (std::size_t at = 0; at <= folders.size();) {
            const std::size_t end = std::min(folders.find(':', at), folders.size());
            const std::string file = folders.substr(at, end - at) + "/" + name;
            if (end > at && ::access(file.c_str(), X_OK) == 0) return file;
            at = end + 1;
        }
    return {};
}

/// Ends of a pipe that are none of the child's.
std::array<int, 2> pipe_apart() {
    constexpr int kAbove = 10;
    std::array<int, 2> low{}, ends{};
    if (::pipe2(low.data(), O_CLOEXEC) != 0)
        throw RunError(fmt::format("no pipe to a browser: {}", std::strerror(errno)));
    for (std::size_t i = 0; i < 2; ++i) {
        ends[i] = ::fcntl(low[i], F_DUPFD_CLOEXEC, kAbove);
        ::close(low[i]);
    }
    return ends;
}

std::string from_base64(std::string_view text) {
    std::string bytes;
    std::uint32_t word = 0;
    int bits = 0;
    for (const char c : text) {
        const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                          : c >= 'a' && c <= 'z' ? c - 'a' + 26
                          : c >= '0' && c <= '9' ? c - '0' + 52
                          : c == '+'             ? 62
                          : c == '/'             ? 63
                                                 : -1;
        if (digit < 0) continue;
        word = word << 6 | static_cast<std::uint32_t>(digit);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        bytes += static_cast<char>(word >> bits & 0xFFU);
    }
    return bytes;
}

}  // namespace

HeadlessBrowser::HeadlessBrowser(int width, int height) {
    const std::string program = installed_browser();
    if (program.empty())
        throw InputError("", "--export", "a picture needs Chromium or Chrome, and none is installed",
                         "`apt install chromium`, or a file that ends with .html");
    std::string name = (std::filesystem::temp_directory_path() / "puckloop-picture-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
        throw RunError(fmt::format("{}: cannot be made: {}", name, std::strerror(errno)));
    folder_ = name;
    std::vector<std::string> words{program,
                                   "--headless=new",
                                   "--disable-gpu",
                                   "--no-first-run",
                                   "--no-default-browser-check",
                                   "--disable-background-networking",
                                   "--disable-component-update",
                                   "--disable-sync",
                                   "--disable-dev-shm-usage",
                                   "--hide-scrollbars",
                                   "--force-device-scale-factor=1",
                                   "--force-color-profile=srgb",
                                   "--user-data-dir=" + (folder_ / "profile").string(),
                                   fmt::format("--window-size={},{}", width, height),
                                   "--remote-debugging-pipe",
                                   "about:blank"};
    if (::geteuid() == 0) words.insert(words.begin() + 1, "--no-sandbox");  // root has none there
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    constexpr int kReads = 3, kWrites = 4;  // by the browser
    const auto down = pipe_apart(), up = pipe_apart();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, down[0], kReads);
    posix_spawn_file_actions_adddup2(&actions, up[1], kWrites);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    const int failed = ::posix_spawn(&child_, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(down[0]);
    ::close(up[1]);
    to_ = down[1];
    from_ = up[0];
    ::signal(SIGPIPE, SIG_IGN);
    try {
        if (failed != 0) {
            child_ = -1;
            throw RunError(fmt::format("{} does not start: {}", program, std::strerror(failed)));
        }
        const json target = call("Target.createTarget", {{"url", "about:blank"}});
        session_ = call("Target.attachToTarget", {{"targetId", target.at("targetId")}, {"flatten", true}})
                       .at("sessionId")
                       .get<std::string>();
        call("Page.enable", json::object());
        call("Emulation.setDeviceMetricsOverride",
             {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
    } catch (...) {
        end();
        throw;
    }
}

HeadlessBrowser::~HeadlessBrowser() {
    end();
}

/// Without its pipe it ends by itself.
void HeadlessBrowser::end() {
    ::close(to_);
    ::close(from_);
    constexpr int kLooks = 500, kLookUs = 10'000;
    bool gone = child_ < 0;
    for (int i = 0; !gone && i < kLooks; ++i) {
        gone = ::waitpid(child_, nullptr, WNOHANG) != 0;
        if (!gone) ::usleep(kLookUs);
    }
    if (!gone) {
        ::kill(child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
    }
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

std::string HeadlessBrowser::message() {
    while (true) {
        if (const std::size_t end = received_.find('\0'); end != std::string::npos) {
            std::string text = received_.substr(0, end);
            received_.erase(0, end + 1);
            return text;
        }
        pollfd asked{from_, POLLIN, 0};
        const int ready = ::poll(&asked, 1, kPatienceMs);
        if (ready < 0 && errno == EINTR) continue;
        if (ready == 0) throw RunError("the browser did not answer within 60 s");
        std::array<char, 65536> piece{};
        const ::ssize_t got = ::read(from_, piece.data(), piece.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) throw RunError("the browser has ended: does it start on this machine?");
        received_.append(piece.data(), static_cast<std::size_t>(got));
    }
}

json HeadlessBrowser::call(const std::string& method, const json& parameters) {
    json request{{"id", ++number_}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) request["sessionId"] = session_;
    const std::string text = request.dump() + '\0';
    for (std::size_t sent = 0; sent < text.size();) {
        const ::ssize_t now = ::write(to_, text.data() + sent, text.size() - sent);
        if (now < 0 && errno == EINTR) continue;
        if (now <= 0) throw RunError("the browser has ended: does it start on this machine?");
        sent += static_cast<std::size_t>(now);
    }
    while (true) {
        json reply = json::parse(message(), nullptr, false);
        if (!reply.is_object() || reply.value("id", 0) != number_) continue;  // an event
        if (reply.contains("error"))
            throw RunError(fmt::format("the browser refused {}: {}", method,
                                       reply["error"].value("message", "no reason given")));
        return reply.value("result", json::object());
    }
}

void HeadlessBrowser::open(const std::string& address) {
    const json done = call("Page.navigate", {{"url", address}});
    if (done.contains("errorText"))
        throw RunError(fmt::format("the browser cannot open the page: {}", done.value("errorText", "")));
}

json HeadlessBrowser::value(const std::string& expression) {
    const json done = call("Runtime.evaluate",
                           {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
    if (done.contains("exceptionDetails"))
        throw RunError(
            fmt::format("the page failed: {}", done["exceptionDetails"].value("text", "no reason given")));
    return done.value("result", json::object()).value("value", json());
}

std::string HeadlessBrowser::picture(const std::string& format, const std::string& element) {
    json asked{{"format", format}};
    constexpr int kQuality = 92;
    if (format == "jpeg") asked["quality"] = kQuality;
    if (!element.empty()) {
        const json box = value(fmt::format(
            "(({{ left, top, width, height }}) => [left, top, width, height])(document.getElementById('{}')"
            ".getBoundingClientRect())",
            element));
        asked["clip"] = {
            {"x", box.at(0)}, {"y", box.at(1)}, {"width", box.at(2)}, {"height", box.at(3)}, {"scale", 1}};
    }
    return from_base64(call("Page.captureScreenshot", asked).at("data").get<std::string>());
}

}  // namespace puckloop::tools
