#include "traces/formats/export.h"

namespace puckloop::tools {

void export_csv(const RecordedTrace& trace, std::ostream& out) {
    out << cosim::kTraceColumns << '\n';
    trace.for_each_checked([&](const cosim::TraceRow& row) { out << to_csv(row) << '\n'; });
}

}  // namespace puckloop::tools
