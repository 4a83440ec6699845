#include "emu/board/timed_lines.h"

#include <algorithm>

namespace puckloop::board {

using cosim::Time;

namespace {
constexpr Time kLook = 10 * cosim::kMillisecond;
}

TimedLines::TimedLines(const std::string& path) : log_(path), next_look_(kLook) {}

Time TimedLines::begin_look() {
    const Time now = next_look_;
    next_look_ += kLook;
    return now;
}

void TimedLines::note(Time time, std::string text) {
    if (is_open()) lines_.emplace_back(time, std::move(text));
}

void TimedLines::mark() {
    log_.mark();
    kept_.reset();
    marked_ = true;
    lines_at_mark_ = lines_.size();
}

void TimedLines::rewind() {
    log_.rewind();
    if (kept_) {
        lines_ = std::move(*kept_);
        kept_.reset();
    } else {
        lines_.resize(lines_at_mark_);
    }
}

void TimedLines::settle() {
    marked_ = false;
    kept_.reset();
    log_.settle();
}

void TimedLines::loaded(Time now) {
    if (!is_open()) return;
    for (const auto& [time, text] : history_)
        line(time, text);
    // The saved board may have had no log, which never looks.
    next_look_ = std::max(next_look_, (now / kLook + 1) * kLook);
    written_ = std::min(written_, now);
}

void TimedLines::write_until(Time now) {
    if (marked_ && !kept_)
        kept_.emplace(lines_.begin(), lines_.begin() + static_cast<std::ptrdiff_t>(lines_at_mark_));
    std::sort(lines_.begin(), lines_.end());
    auto next = lines_.begin();
    for (; next != lines_.end() && next->first <= now; ++next) {
        line(next->first, next->second);
        history_.push_back(std::move(*next));
    }
    lines_.erase(lines_.begin(), next);
    written_ = now;
}

}  // namespace puckloop::board
