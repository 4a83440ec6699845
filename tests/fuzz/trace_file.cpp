// Recorded traces, trace.csv.

#include "base/error.h"
#include "cosim/trace/trace_csv.h"
#include "tests/fuzz/target.h"

#include <sstream>

void puckloop::fuzz::run_input(Input input) {
    std::istringstream in{std::string(text_of(input))};
    try {
        cosim::read_trace(in, "fuzzed.csv", [](const cosim::TraceRow& row) { cosim::to_csv(row); });
    } catch (const InputError& error) {
        require_refusal(error.what(), "fuzzed.csv");
    }
}
