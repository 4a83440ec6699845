#include "base/logs/log.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/plain_text.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <mutex>
#include <utility>

namespace puckloop::log {

namespace {

constexpr const char* kVariable = "PUCKLOOP_LOG";  // "info:/absolute/file", "info:" for standard error
constexpr std::array<std::pair<const char*, spdlog::level::level_enum>, 6> kLevels{
    {{"trace", spdlog::level::trace},
     {"debug", spdlog::level::debug},
     {"info", spdlog::level::info},
     {"warning", spdlog::level::warn},
     {"error", spdlog::level::err},
     {"off", spdlog::level::off}}};

spdlog::level::level_enum level_of(Level level) {
    return kLevels.at(static_cast<std::size_t>(level)).second;
}

/// Each line in one write(): the lines of several processes do not mix.
class LineSink : public spdlog::sinks::base_sink<std::mutex> {
  public:
    explicit LineSink(int descriptor) : descriptor_(descriptor) {}
    ~LineSink() override {
        if (descriptor_ != STDERR_FILENO) ::close(descriptor_);
    }

  protected:
    void sink_it_(const spdlog::details::log_msg& message) override {
        spdlog::memory_buf_t line;
        formatter_->format(message, line);
        // A log that cannot be written is no reason to end a run.
        [[maybe_unused]] const auto written = ::write(descriptor_, line.data(), line.size());
    }
    void flush_() override {}

  private:
    int descriptor_;
};

struct State {
    Settings settings;
    std::shared_ptr<spdlog::logger> logger;
};

State& state() {
    static State the_state;
    return the_state;
}

}  // namespace

Level level_named(const std::string& name) {
    for (std::size_t i = 0; i < kLevels.size(); ++i)
        if (name == kLevels.at(i).first) return static_cast<Level>(i);
    throw InputError("", "--log-level", fmt::format("'{}' is not a level", name),
                     "trace, debug, info, warning, error or off");
}

void start(const std::string& name, const Settings& settings) {
    State& log = state();
    log.settings = settings;
    log.logger.reset();
    int descriptor = STDERR_FILENO;
    if (!settings.file.empty()) {
        log.settings.file = std::filesystem::absolute(settings.file).string();  // whoever changes the folder
        descriptor = open_new_file(settings.file, O_APPEND);
        if (descriptor < 0)
            throw InputError(settings.file, "", "cannot be opened: " + why_not_written(errno),
                             "a log file that can be written");
    }
    log.logger = std::make_shared<spdlog::logger>(name, std::make_shared<LineSink>(descriptor));
    log.logger->set_level(level_of(settings.level));
    log.logger->set_pattern("%Y-%m-%d %H:%M:%S.%e %-7l [%n %P] %v");
}

void share_with_children() {
    const Settings& settings = state().settings;
    if (settings.level == Level::Off) return;
    const char* level = kLevels.at(static_cast<std::size_t>(settings.level)).first;
    ::setenv(kVariable, fmt::format("{}:{}", level, settings.file).c_str(), 1);
}

void start_in_child(const std::string& name) {
    const char* shared = std::getenv(kVariable);
    if (shared == nullptr) return;
    const std::string text = shared;
    ::unsetenv(kVariable);
    const auto colon = text.find(':');
    if (colon == std::string::npos) return;
    try {
        start(name, {level_named(text.substr(0, colon)), text.substr(colon + 1)});
    } catch (const InputError&) {
    }
}

bool wants(Level level) {
    const auto& logger = state().logger;
    return logger && logger->should_log(level_of(level));
}

void write(Level level, std::string_view text) {
    const std::string line = plain_text(text, kLongestMessage);
    state().logger->log(level_of(level), spdlog::string_view_t(line.data(), line.size()));
}

}  // namespace puckloop::log
