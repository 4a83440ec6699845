#include "base/logs/node_log.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <utility>

namespace puckloop {

namespace {
[[noreturn]] void fail(const std::string& path) {
    throw RunError(fmt::format("cannot write {}: {}", path, why_not_written(errno)));
}
}  // namespace

NodeLog::NodeLog(std::string path) : path_(std::move(path)) {
    if (path_.empty()) return;
    file_.reset(new_file(path_));
    if (!file_) fail(path_);
}

void NodeLog::line(double seconds, std::string_view text) {
    if (!file_) return;
    const std::string whole = fmt::format("[{:12.6f} s] {}\n", seconds, text);
    if (marked_)
        kept_back_ += whole;
    else
        write(whole);
}

void NodeLog::mark() {
    settle();
    marked_ = true;
}

void NodeLog::settle() {
    marked_ = false;
    if (kept_back_.empty()) return;
    const std::string lines = std::exchange(kept_back_, {});
    write(lines);
}

void NodeLog::write(std::string_view lines) {
    if (!file_) return;
    if (std::fwrite(lines.data(), 1, lines.size(), file_.get()) == lines.size() &&
        std::fflush(file_.get()) == 0)
        return;
    const int cause = errno;
    file_.reset();
    errno = cause;
    fail(path_);
}

}  // namespace puckloop
