#include "tools/viewer/film.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/files/partial_file.h"
#include "base/files/text_file.h"
#include "base/json.h"
#include "tools/viewer/headless_browser.h"
#include "view/events/read_events.h"
#include "view/export_page.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <system_error>
#include <vector>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;
constexpr double kMostPictures = 200'000;  // of a film

/// ffmpeg, which takes pictures one after the other.
class Encoder {
  public:
    Encoder(const FilmOptions& options, std::string file) : file_(std::move(file)) {
        const bool webm = options.file.ends_with(".webm");
        std::vector<std::string> words{"ffmpeg", "-hide_banner", "-loglevel", "error", "-y", "-f",
                                       "image2pipe", "-c:v", "mjpeg", "-framerate",
                                       fmt::format("{:g}", options.rate), "-i", "-",
                                       // Such films have an even number of lines and columns.
                                       "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"};
        const std::vector<std::string> form =
            webm ? std::vector<std::string>{"-c:v", "libvpx-vp9", "-b:v", "0",  "-crf",
                                            "32",   "-row-mt",    "1",    "-f", "webm"}
                 : std::vector<std::string>{"-c:v", "libx264", "-movflags", "+faststart", "-f", "mp4"};
        words.insert(words.end(), form.begin(), form.end());
        words.push_back("file:" + file_);
        std::vector<char*> arguments;
        for (std::string& word : words)
            arguments.push_back(word.data());
        arguments.push_back(nullptr);
        int ends[2]{};
        if (::pipe2(ends, O_CLOEXEC) != 0)
            throw RunError(fmt::format("no pipe to ffmpeg: {}", std::strerror(errno)));
        ::signal(SIGPIPE, SIG_IGN);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
        const int failed = ::posix_spawnp(&child_, "ffmpeg", &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        ::close(ends[0]);
        to_ = ends[1];
        if (failed == 0) return;
        ::close(to_);
        throw InputError("", "--export", "a film needs ffmpeg, which is not installed",
                         "`apt install ffmpeg`, or a file that ends with .html or .png");
    }
    ~Encoder() {
        if (to_ >= 0) ::close(to_);
        if (child_ > 0) ::waitpid(child_, nullptr, 0);
    }
    Encoder(const Encoder&) = delete;
    Encoder& operator=(const Encoder&) = delete;

    void add(const std::string& picture) {
        for (std::size_t sent = 0; sent < picture.size();) {
            const ::ssize_t now = ::write(to_, picture.data() + sent, picture.size() - sent);
            if (now < 0 && errno == EINTR) continue;
            if (now <= 0) throw RunError("ffmpeg has ended before the film's end");
            sent += static_cast<std::size_t>(now);
        }
    }
    void finish() {
        ::close(to_);
        to_ = -1;
        int status = 0;
        while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
        }
        child_ = -1;
        if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw RunError("ffmpeg has failed");
    }

  private:
    std::string file_;
    pid_t child_ = -1;
    int to_ = -1;
};

/// As a file: that of a folder is not served to anybody.
std::string address_of(const fs::path& file) {
    std::string address = "file://";
    for (const char c : file.string())
        address += std::isalnum(static_cast<unsigned char>(c)) != 0 || std::strchr("/-_.", c) != nullptr
                       ? std::string(1, c)
                       : fmt::format("%{:02x}", static_cast<unsigned char>(c));
    return address;
}

}  // namespace

void write_film(const view::Recording& recording, const FilmOptions& options) {
    const double last = recording.duration_s(), end = options.end.value_or(last);
    const bool film = !options.file.ends_with(".png");
    if (options.begin > last || end > last + 1e-9)
        throw InputError("", film ? "--end" : "--png", fmt::format("the run ends at {:.6g} s", last),
                         "a time within the run");
    if (film && end <= options.begin)
        throw InputError("", "--end", fmt::format("{:g} s is not after {:g} s", end, options.begin),
                         "a later time");
    const double pictures = film ? std::floor((end - options.begin) / options.speed * options.rate) + 1 : 1;
    if (pictures > kMostPictures)
        throw InputError("", "--export", fmt::format("a film of {:.0f} pictures is too long", pictures),
                         "a higher --speed, a lower --fps, or a part of the run");
    view::EventReader events(recording);
    const std::string page = view::exported_page(recording, events);
    HeadlessBrowser browser(options.width, options.height);
    const fs::path file = browser.folder() / "page.html";
    write_file(file, page);
    browser.open(address_of(file));
    // The page of before is gone when its successor has its name.
    browser.value(
        "new Promise((done) => { const look = () => { if (document.body && document.body.dataset.ready === "
        "'all') done(1); else setTimeout(look, 20); }; look(); })");
    browser.value(fmt::format("window.puckloopView.still({})", options.dark));
    const std::string element = options.part == "page" ? "" : options.part + "-part";
    const auto show = [&](double time) {
        browser.value(fmt::format("window.puckloopView.show({:.9f}, {:.9f})", time, options.speed));
    };
    if (!film) {
        show(options.begin);
        const std::string picture = browser.picture("png", element);
        make_new_file(options.file);
        return write_file(options.file, picture);
    }
    const std::string part = options.file + ".part";
    make_new_file(part);
    try {
        Encoder encoder(options, part);
        for (double i = 0; i < pictures; ++i) {
            show(std::min(end, options.begin + i * options.speed / options.rate));
            encoder.add(browser.picture("jpeg", element));
        }
        encoder.finish();
        fs::rename(part, options.file);
    } catch (...) {
        remove_partial(part);
        throw;
    }
}

}  // namespace puckloop::tools
