#include "run/report/status_line.h"

#include <fmt/format.h>

#include <cstdio>
#include <unistd.h>

namespace puckloop::tools {

StatusLine::StatusLine(std::optional<double> duration)
    : duration_(duration), on_terminal_(::isatty(STDERR_FILENO) == 1) {}

StatusLine::~StatusLine() {
    clear();
}

void StatusLine::show(const cosim::Progress& progress) {
    if (!on_terminal_) return;
    const double seconds = cosim::to_seconds(progress.time);
    std::string text = fmt::format("{:8.1f} s", seconds);
    if (duration_) text += fmt::format(" of {:g} s ({:.0f} %)", *duration_, 100.0 * seconds / *duration_);
    fmt::print(stderr, "\r{}, {:.1f}x real time\033[K", text, progress.factor);
    std::fflush(stderr);
    shown_ = true;
}

void StatusLine::clear() {
    if (!shown_) return;
    std::fputs("\r\033[K", stderr);
    std::fflush(stderr);
    shown_ = false;
}

}  // namespace puckloop::tools
