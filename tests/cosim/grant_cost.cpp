// Measures what a grant costs in both placements; no test, run by hand: cosim_grant_cost [seconds]

#include "toy_run.h"

#include <fmt/format.h>

#include <cstdlib>

int main(int argc, char** argv) {
    using namespace puckloop::cosim;
    const double seconds = argc > 1 ? std::atof(argv[1]) : 1.0;
    for (const bool in_process : {true, false}) {
        for (const int count : {2, 4}) {
            toy::Run run;
            for (int n = 0; n < count; ++n)
                run.nodes.push_back({fmt::format("n{}", n), n % 2 == 0 ? "echo first=1" : "echo"});
            for (int n = 0; n < count; n += 2)
                run.links.push_back(toy::uart(fmt::format("wire{}", n / 2), {fmt::format("n{}", n), "uart0"},
                                              {fmt::format("n{}", n + 1), "uart0"}));
            run.options.duration = from_seconds(seconds);
            run.options.in_process = in_process;
            const Outcome outcome = run();
            fmt::print("{} nodes, {}: {} grants in {:.3f} s, {:.2f} us a grant, {:.1f} x real time\n", count,
                       in_process ? "one process" : "processes of their own", outcome.grants, outcome.wall_s,
                       1e6 * outcome.wall_s / static_cast<double>(outcome.grants),
                       to_seconds(outcome.simulated) / outcome.wall_s);
        }
    }
}
