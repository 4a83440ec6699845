#include "physics/events/journal.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace puckloop::physics {

std::string seconds_text(cosim::Time time) {
    std::string text =
        fmt::format("{}.{:06}", time / cosim::kSecond, time % cosim::kSecond / cosim::kMicrosecond);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text + " s";
}

Journal::Journal(const EventPlan& plan)
    : plan_(plan), done_(plan.events.size()), refused_(plan.events.size()) {
    if (plan.journal.empty()) return;
    file_.reset(new_file(plan.journal));
    if (!file_) throw RunError(fmt::format("cannot write {}: {}", plan.journal, why_not_written(errno)));
    write("# What was done to the world. The same again: puckloop run SCENARIO --events THIS_FILE\n");
    if (!plan.repeats)
        write("# Linux programs ran by the wall clock (--realtime): they will not do the same again. With "
              "--paced "
              "a run can be repeated.\n");
}

void Journal::write(const std::string& text) {
    if (!file_) return;
    if (std::fputs(text.c_str(), file_.get()) < 0 || std::fflush(file_.get()) != 0)
        throw RunError(fmt::format("cannot write {}: {}", plan_.journal, std::strerror(errno)));
}

std::string Journal::name_of(std::size_t event) const {
    return event == kLive ? "command" : plan_.events[event].name;
}

void Journal::done(std::size_t event, cosim::Time time, const Action& action) {
    entries_.push_back({name_of(event), time, action.command, {}});
    if (event != kLive) ++done_[event];
    write(fmt::format("\n[[event]]\nat = \"{}\"\n{}", seconds_text(time), action.toml));
}

void Journal::refused(std::size_t event, cosim::Time time, const Action& action, const std::string& why) {
    entries_.push_back({name_of(event), time, action.command, why});
    if (event != kLive) ++refused_[event];
}

std::vector<std::string> Journal::warnings() const {
    std::vector<std::string> warnings;
    for (std::size_t i = 0; i < plan_.events.size(); ++i) {
        const Event& event = plan_.events[i];
        const std::string what = fmt::format("{} ({})", event.name, event.place);
        if (refused_[i] > 0) {
            for (const Entry& entry : entries_)
                if (entry.event == event.name && !entry.refused.empty()) {
                    warnings.push_back(
                        fmt::format("{} was not carried out at {}{}: {}", what, seconds_text(entry.time),
                                    refused_[i] > 1 ? fmt::format(" and {} times more", refused_[i] - 1) : "",
                                    entry.refused));
                    break;
                }
        } else if (done_[i] == 0 && event.at) {
            warnings.push_back(
                fmt::format("{} never happened: {} was not reached", what, seconds_text(*event.at)));
        } else if (done_[i] == 0) {
            warnings.push_back(fmt::format("{} never happened: its condition never came true", what));
        }
    }
    return warnings;
}

}  // namespace puckloop::physics
