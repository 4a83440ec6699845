#pragma once
// Changes of all lines of a trace in the order of time, from a file that is never in memory as a whole.

#include "traces/lines.h"
#include "traces/recorded_trace.h"
#include "traces/reorder_buffer.h"

#include <optional>
#include <utility>
#include <vector>

namespace puckloop::tools {

/// What one pass over the whole trace finds, for the passes after it.
struct LineSurvey {
    std::vector<Line> lines;
    cosim::Time late = 0, last = 0, shortest_bit = cosim::kNever;
};

LineSurvey survey(const RecordedTrace& trace, const FaultMarks& marks);

/// Levels that changed at one time.
struct Edges {
    cosim::Time time = 0;
    std::vector<std::pair<std::size_t, bool>> levels;  ///< line, level; by line
};

class EdgeStream {
  public:
    /// `marks` must outlive it.
    EdgeStream(const RecordedTrace& trace, const FaultMarks& marks, const LineSurvey& survey);
    EdgeStream(const EdgeStream&) = delete;
    EdgeStream& operator=(const EdgeStream&) = delete;

    /// Nothing at the end.
    std::optional<Edges> next();

  private:
    void fill();

    RecordedTrace::Cursor cursor_;
    cosim::Time late_;
    ReorderBuffer<LineEvent> buffer_;
    LineRenderer renderer_;
    std::vector<bool> rests_high_, level_;
    std::vector<int> reasons_;
    cosim::Time settled_ = -1;  // nothing earlier comes any more
};

}  // namespace puckloop::tools
