#include "bench/history.h"

#include "base/states/archive.h"
#include "debug/debug_chip.h"

#include <algorithm>

namespace puckloop::exec {

History::History(const MakeTarget& make, TargetListener& listener)
    : listener_(listener), inner_(make(*this)) {}

void History::begin(debug::DebugChip& chip) {
    debug_chip_ = &chip;
    if (saves()) take();
}

void History::take() {
    Saved saved{inner_->now(), debug_chip_->cycle(), acts_.size(), {}};
    StateWriter archive(saved.bytes);
    inner_->save_state(archive);
    states_.push_back(std::move(saved));
}

void History::note() {
    if (past_ || states_.empty() || inner_->now() < states_.back().time + interval_) return;
    take();
    if (states_.size() < kMostStates) return;
    // Every other one goes; the first stays.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < states_.size(); i += 2)
        if (kept++ != i) states_[kept - 1] = std::move(states_[i]);
    states_.resize(kept);
    interval_ *= 2;
}

std::optional<std::size_t> History::state_before(std::uint64_t cycle) const {
    for (std::size_t i = states_.size(); i > 0; --i)
        if (states_[i - 1].cycle < cycle) return i - 1;
    return std::nullopt;
}

void History::restore(std::size_t state) {
    if (!past_) present_ = inner_->now();
    past_ = true;
    const Saved& saved = states_[state];
    next_act_ = saved.next_act;
    inner_->repeat(true);
    StateReader archive(saved.bytes);
    inner_->restore_state(archive);
}

bool History::repeat_for(cosim::Time slice) {
    const cosim::Time end = std::min(inner_->now() + slice, present_);
    while (true) {
        const cosim::Time next = next_act_ < acts_.size() ? std::min(acts_[next_act_].time, end) : end;
        if (next > inner_->now()) {
            inner_->run_until(next);
            if (inner_->stopped()) return true;
        }
        if (next_act_ == acts_.size() || acts_[next_act_].time > inner_->now()) break;
        acts_[next_act_++].act(*inner_);
    }
    if (inner_->now() >= present_) {
        past_ = false;
        inner_->repeat(false);
    }
    return false;
}

void History::apply(std::function<void(Target&)> act) {
    if (saves() && debug_chip_) acts_.push_back({inner_->now(), act});
    act(*inner_);
}

void History::set_signal(std::uint16_t id, double value) {
    apply([=](Target& target) { target.set_signal(id, value); });
}
void History::uart_receive(int unit, const cosim::UartFrame& frame) {
    apply([=](Target& target) { target.uart_receive(unit, frame); });
}
void History::i2c_slave_phase(const cosim::I2cPhase& phase) {
    apply([=](Target& target) { target.i2c_slave_phase(phase); });
}
void History::reset_button() {
    apply([](Target& target) { target.reset_button(); });
}

void History::uart_sent(int unit, const cosim::UartFrame& frame) {
    if (!past_) listener_.uart_sent(unit, frame);
}
void History::i2c_phase(int unit, const cosim::I2cPhase& phase) {
    if (!past_) listener_.i2c_phase(unit, phase);
}
void History::i2c_answered(const cosim::I2cPhase& answer, cosim::Time time) {
    if (!past_) listener_.i2c_answered(answer, time);
}
void History::pin_changed(std::string_view pin, std::string_view function, std::optional<bool> level,
                          cosim::Time time) {
    if (!past_) listener_.pin_changed(pin, function, level, time);
}
void History::signal_changed(std::string_view name, double value, cosim::Time time) {
    if (!past_) listener_.signal_changed(name, value, time);
}
void History::sound_sample(double value, cosim::Time time) {
    if (!past_) listener_.sound_sample(value, time);
}

}  // namespace puckloop::exec
