#include "linuxboard/coordinator/event_log.h"

#include "base/error.h"

#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace puckloop::coordinator {

namespace {

std::string field(std::string_view text) {
    std::string out;
    bool quoted = false;
    for (const char c : text) {
        if (std::isprint(static_cast<unsigned char>(c)) == 0) {
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
            continue;
        }
        quoted |= c == ',' || c == '"';
        if (c == '"') out += '"';
        out += c;
    }
    return quoted ? '"' + out + '"' : out;
}

/// The next field of `line` from `at` on, which moves behind its comma; false if its quotes are wrong.
bool next_field(const std::string& line, std::size_t& at, std::string& out) {
    out.clear();
    if (at < line.size() && line[at] == '"') {
        for (++at; at < line.size(); ++at) {
            if (line[at] != '"') {
                out += line[at];
            } else if (at + 1 < line.size() && line[at + 1] == '"') {
                out += line[++at];
            } else {
                break;
            }
        }
        if (at == line.size()) return false;
        ++at;
        if (at < line.size() && line[at] != ',') return false;
    } else {
        while (at < line.size() && line[at] != ',')
            out += line[at++];
    }
    ++at;
    return true;
}

}  // namespace

std::string to_csv(const Event& event) {
    return fmt::format("{:.3f},{},{},{},{}", event.time, field(event.tam), field(event.event),
                       field(event.value), field(event.detail));
}

Event from_csv(const std::string& line, const std::string& file, int number) {
    const auto fail = [&](const char* problem) {
        throw InputError(file, fmt::format("line {}", number), problem, kEventColumns);
    };
    Event event;
    std::string time;
    std::size_t at = 0;
    for (std::string* part : {&time, &event.tam, &event.event, &event.value, &event.detail}) {
        if (at > line.size()) fail("has too few fields");
        if (!next_field(line, at, *part)) fail("has a text whose quotes do not match");
    }
    if (at <= line.size()) fail("has too many fields");
    const auto [end, error] = std::from_chars(time.data(), time.data() + time.size(), event.time);
    if (error != std::errc() || end != time.data() + time.size() || !(event.time >= 0 && event.time < 1e9))
        fail("does not begin with a time in seconds");
    return event;
}

EventLog::EventLog(const std::string& file, bool show) : name_(file), show_(show) {
    if (file.empty()) return;
    file_ = std::fopen(file.c_str(), "we");
    if (file_ == nullptr) throw std::runtime_error(file + ": " + std::strerror(errno));
    std::fprintf(file_, "%s\n", kEventColumns);
    std::fflush(file_);
}

EventLog::~EventLog() {
    if (file_ != nullptr) std::fclose(file_);
}

void EventLog::add(Event event) {
    if (show_)
        std::puts(fmt::format("[{:9.3f} s] {:<6} {} {} {}", event.time, field(event.tam), event.event,
                              field(event.value), field(event.detail))
                      .c_str());
    if (file_ != nullptr) {
        const std::string line = to_csv(event) + '\n';
        if (std::fwrite(line.data(), 1, line.size(), file_) != line.size() || std::fflush(file_) != 0) {
            std::fprintf(stderr, "puckloop-coordinator: %s: %s; no more events are written\n", name_.c_str(),
                         std::strerror(errno));
            std::fclose(std::exchange(file_, nullptr));
        }
    }
    if (event.tam.empty() || event.event == "state" || event.event == "robot")
        drawn_.push_back(std::move(event));
}

std::vector<Event> read_events(const std::string& file) {
    std::ifstream in(file);
    if (!in) throw InputError(file, "", "cannot be read", "an event table");
    std::vector<Event> events;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        if (in.eof()) break;  // cut short
        if (number == 1 && line != kEventColumns)
            throw InputError(file, "line 1", "is not the head of an event table", kEventColumns);
        if (number > 1) events.push_back(from_csv(line, file, number));
    }
    return events;
}

}  // namespace puckloop::coordinator
