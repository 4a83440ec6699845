#pragma once
// The event table: a CSV file, one line per event, each written out at once, so that what a killed program
// leaves can be read. Columns and events: docs/coordinator.md.

#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::coordinator {

inline constexpr char kEventColumns[] = "time_s,tam,event,value,detail";

struct Event {
    double time = 0;  ///< s since the program began
    std::string tam;  ///< empty: of the coordinator itself
    std::string event, value, detail;
    bool operator==(const Event&) const = default;
};

/// One line of the table, without its end; what is not printable is written as \xNN.
std::string to_csv(const Event& event);
/// The inverse. Throws InputError (file, line).
Event from_csv(const std::string& line, const std::string& file, int number);

class EventLog {
  public:
    /// An empty `file`: none is written. With `show` each event is also a line on standard output. Throws
    /// std::runtime_error if the file cannot be written.
    EventLog(const std::string& file, bool show);
    ~EventLog();
    EventLog(const EventLog&) = delete;
    EventLog& operator=(const EventLog&) = delete;

    void add(Event event);
    /// Those of which the picture is made: states, robots, and what the coordinator itself did.
    const std::vector<Event>& drawn() const { return drawn_; }

  private:
    std::string name_;
    std::FILE* file_ = nullptr;
    bool show_;
    std::vector<Event> drawn_;
};

/// The events of a table; a last line that was not finished is left out. Throws InputError.
std::vector<Event> read_events(const std::string& file);

}  // namespace puckloop::coordinator
