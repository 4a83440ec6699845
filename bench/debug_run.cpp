#include "bench/debug_run.h"

namespace puckloop::exec {

using debug::Resume;
using debug::Stop;

DebugRun::DebugRun(Bench& bench, const std::string& where)
    : bench_(bench),
      debugged_(bench),
      socket_("--gdb", where),
      session_(socket_, debugged_, [this] { return interrupted_ && interrupted_(); }) {}

Bench::End DebugRun::run(cosim::Time budget, bool paced) {
    interrupted_ = std::move(bench_.interrupted);
    debugged_.wants_stop = [this] { return session_.wants_stop(); };
    debugged_.wants_end = interrupted_;
    debugged_.begin(budget, paced);
    if (!socket_.accept(interrupted_)) return Bench::End::Interrupted;
    Stop stop;
    while (true) {
        switch (session_.serve(stop)) {
        case Resume::Kill:
            return Bench::End::Interrupted;
        case Resume::Detach:
            debugged_.control().clear();
            stop = debugged_.forward(false);
            break;
        case Resume::Step:
            stop = debugged_.forward(true);
            break;
        case Resume::Continue:
            stop = debugged_.forward(false);
            break;
        case Resume::ReverseStep:
            stop = debugged_.backward(true);
            break;
        case Resume::ReverseContinue:
            stop = debugged_.backward(false);
            break;
        }
        if (stop.why == Stop::Why::End) return debugged_.end();
    }
}

}  // namespace puckloop::exec
