#include "bench/debugged.h"

#include "bench/history.h"

namespace puckloop::exec {

namespace {

using debug::Stop;

/// How long is repeated before anybody asks whether the debugger wants to stop.
constexpr cosim::Time kSlice = 5 * cosim::kMillisecond;

}  // namespace

Debugged::Debugged(Bench& bench)
    : bench_(bench), history_(*bench.history()), chip_(bench.target().debug_chip()), control_(*chip_) {}

void Debugged::begin(cosim::Time budget, bool paced) {
    budget_ = budget;
    paced_ = paced;
    history_.begin(*chip_);
}

bool Debugged::in_past() const {
    return history_.in_past();
}

bool Debugged::repeat() {
    while (history_.in_past()) {
        if (history_.repeat_for(kSlice)) return true;
        if (wants_stop && wants_stop()) return false;
    }
    return true;
}

Stop Debugged::forward(bool step) {
    control_.begin(step);
    const bool repeated = repeat();
    if (!repeated || history_.in_past()) return control_.end().value_or(Stop{Stop::Why::Interrupt});
    bool wanted = false;
    bench_.interrupted = [this, &wanted] {
        history_.note();
        wanted = wants_stop && wants_stop();
        return wanted || (wants_end && wants_end());
    };
    if (paced_) bench_.pace_by_wall_clock();
    end_ = bench_.run_until(budget_);
    bench_.interrupted = nullptr;
    const std::optional<Stop> stop = control_.end();
    if (end_ == Bench::End::Address) return stop.value_or(Stop{Stop::Why::Interrupt});
    if (wanted) return Stop{Stop::Why::Interrupt};
    return Stop{Stop::Why::End};
}

Stop Debugged::backward(bool steps) {
    const std::uint64_t here = chip_->cycle();
    std::optional<std::size_t> state = history_.state_before(here);
    if (!state) return Stop{Stop::Why::Begin};
    while (true) {
        history_.restore(*state);
        control_.begin_search(steps, here);
        const bool wanted = !repeat();
        control_.end();
        const auto found = control_.found();
        history_.restore(*state);
        if (wanted) return Stop{Stop::Why::Interrupt};
        if (found) {
            control_.begin_seek(found->position);
            while (!history_.repeat_for(kSlice)) {
            }
            control_.end();
            return found->stop;
        }
        if (*state == 0) return Stop{Stop::Why::Begin};
        --*state;
    }
}

std::string Debugged::frozen() const {
    return history_.in_past() ? "the past cannot be changed: continue to the present first" : "";
}

bool Debugged::change(std::function<bool(debug::DebugChip&)> change) {
    const auto done = std::make_shared<bool>();
    history_.apply([this, change = std::move(change), done](Target&) { *done = change(*chip_); });
    return *done;
}

std::string Debugged::summary() {
    std::string text = bench_.target().chip_text();
    for (const std::string& line : bench_.target().warnings())
        text += "warning: " + line + "\n";
    return text;
}

}  // namespace puckloop::exec
