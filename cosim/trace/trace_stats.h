#pragma once
// What a recorded trace holds, counted for each link and sender.

#include "cosim/trace/link_stats.h"
#include "cosim/trace/trace_row.h"

#include <map>
#include <string>
#include <utility>

namespace puckloop::cosim {

class TraceStats {
  public:
    void add(const TraceRow& row);

    /// A table, one line per link and sender.
    std::string text() const;
    /// {"first_s", "last_s", "messages", "links": [{"link", "from", counters}]}
    std::string json() const;

  private:
    struct Entry {
        LinkStats stats;
        Time first = 0;
        Time last = 0;
    };
    std::map<std::pair<std::string, std::string>, Entry> entries_;
    std::uint64_t messages_ = 0;
    Time first_ = 0;
    Time last_ = 0;
};

}  // namespace puckloop::cosim
