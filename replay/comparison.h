#pragma once
// What a node sends now against what it sent when it was recorded, link by link, in the order of sending.
//
// Rows that a fault of the recorded run harmed are compared as far as they show what was sent: a lost frame
// wholly but for its fate, a changed or delayed one not in its content, and what the fault itself put on the
// line is ignored. On a link with faults a message may be recorded late, behind others: until then it is
// outstanding.

#include "cosim/trace/trace_row.h"

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace puckloop::tools {

struct ReplayDifference {
    cosim::Time time = 0;
    std::string link;
    std::uint64_t message = 0;       ///< counted from 1 on this link
    std::string recorded, replayed;  ///< rows of a trace; empty: no message
};

class SentComparison {
  public:
    /// `with_faults`: links whose messages may be late.
    explicit SentComparison(std::set<std::string> with_faults = {}) : with_faults_(std::move(with_faults)) {}

    void recorded(const cosim::TraceRow& row);
    void replayed(const cosim::TraceRow& row);
    /// The first difference in what arrives before `end`, once all before `end` was given.
    std::optional<ReplayDifference> check(cosim::Time end);

    /// The record ends at `end`: what is outstanding for long was never sent then.
    std::optional<ReplayDifference> finish(cosim::Time end) const;

    std::uint64_t equal() const { return equal_; }

  private:
    struct Link {
        std::deque<cosim::TraceRow> recorded, replayed;
        std::deque<cosim::TraceRow> outstanding;  ///< sent again, and their rows are still to come
        bool faults = false;
        std::uint64_t messages = 0;
    };
    Link& link(const std::string& name);
    void take_harmed(Link& link);
    bool take_sound(Link& link);
    std::optional<ReplayDifference> check(const std::string& name, Link& link, cosim::Time end);

    std::set<std::string> with_faults_;
    std::map<std::string, Link> links_;
    std::uint64_t equal_ = 0;
};

}  // namespace puckloop::tools
