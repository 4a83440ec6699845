#include "traces/edges.h"

#include <set>

namespace puckloop::tools {

using cosim::Time;

LineSurvey survey(const RecordedTrace& trace, const FaultMarks& marks) {
    LineRenderer renderer([](Time, const LineEvent&) {}, marks);
    trace.for_each_checked([&](const cosim::TraceRow& row) { renderer.add(row); });
    renderer.end();
    return {renderer.lines(), renderer.how_late(), renderer.last(), renderer.shortest_bit()};
}

EdgeStream::EdgeStream(const RecordedTrace& trace, const FaultMarks& marks, const LineSurvey& survey)
    : cursor_(trace),
      late_(survey.late),
      renderer_([this](Time time, const LineEvent& event) { buffer_.push(time, event); }, marks),
      reasons_(survey.lines.size()) {
    for (const Line& line : survey.lines)
        rests_high_.push_back(line.rests_high());
    level_ = rests_high_;
}

/// Reads until the first event of the buffer is the next one.
void EdgeStream::fill() {
    while (settled_ != cosim::kNever && (buffer_.empty() || buffer_.first() >= settled_)) {
        if (const auto row = cursor_.next()) {
            renderer_.add(*row);
            settled_ = row->time - late_;
        } else {
            renderer_.end();
            settled_ = cosim::kNever;
        }
    }
}

std::optional<Edges> EdgeStream::next() {
    for (;;) {
        fill();
        if (buffer_.empty()) return std::nullopt;
        Edges edges;
        edges.time = buffer_.first();
        std::set<std::size_t> touched;
        while (!buffer_.empty() && buffer_.first() == edges.time) {
            const LineEvent event = buffer_.pop();
            reasons_[event.line] += event.change;
            touched.insert(event.line);
        }
        for (const std::size_t line : touched) {
            const bool level = (reasons_[line] > 0) != rests_high_[line];
            if (level == level_[line]) continue;
            level_[line] = level;
            edges.levels.emplace_back(line, level);
        }
        if (!edges.levels.empty()) return edges;
    }
}

}  // namespace puckloop::tools
