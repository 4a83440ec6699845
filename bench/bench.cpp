#include "bench/bench.h"

#include "bench/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace puckloop::exec {

namespace {

constexpr cosim::Time kPollPeriod = cosim::kMillisecond;
/// A paced run that is late by no more than this catches up, as fast as it can.
constexpr cosim::Time kMostBehind = 50 * cosim::kMillisecond;

std::int64_t wall_nanoseconds() {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
}

}  // namespace

Bench::Bench(const BenchOptions& options)
    : logs_(options.log_folder.empty() ? nullptr : std::make_unique<Logs>(options.log_folder)),
      target_(make(options)),
      lines_{UartLine{1, options.baud[0], *target_, logs_.get()},
             UartLine{2, options.baud[1], *target_, logs_.get()}} {
    if (logs_) speaker_.emplace(options.log_folder + "/speaker.wav");
}

std::unique_ptr<Target> Bench::make(const BenchOptions& options) {
    const auto make = [&options](TargetListener& listener) {
        return options.mcu.empty() ? make_board(options.board, options.target, listener)
                                   : make_bare_chip(options.mcu, options.target, listener);
    };
    if (!options.record) return make(*this);
    auto history = std::make_unique<History>(make, static_cast<TargetListener&>(*this));
    history_ = history.get();
    return history;
}

void Bench::pace_by_wall_clock() {
    paced_ = true;
    wall_origin_ns_ = wall_nanoseconds() - now_ / cosim::kNanosecond;
}

void Bench::stimulate(const std::vector<StimulusLine>& stimulus) {
    stimulus_.erase(stimulus_.begin(), stimulus_.begin() + static_cast<std::ptrdiff_t>(next_stimulus_));
    next_stimulus_ = 0;
    stimulus_.insert(stimulus_.end(), stimulus.begin(), stimulus.end());
    std::stable_sort(stimulus_.begin(), stimulus_.end(),
                     [](const StimulusLine& a, const StimulusLine& b) { return a.time < b.time; });
}

Bench::End Bench::run_until(cosim::Time until) {
    while (now_ < until) {
        if (now_ >= next_poll_) {
            poll();
            next_poll_ = now_ - now_ % kPollPeriod + kPollPeriod;
            if (interrupted && interrupted()) return End::Interrupted;
        }
        apply_stimulus();
        cosim::Time next = std::min({until, next_poll_, lines_[0].due(), lines_[1].due()});
        if (next_stimulus_ < stimulus_.size()) next = std::min(next, stimulus_[next_stimulus_].time);
        if (master_) next = std::min(next, master_->limit());
        next = std::max(next, now_);
        if (next > now_) target_->run_until(next);
        if (target_->stopped()) {
            now_ = target_->now();
            return End::Address;
        }
        now_ = next;
        if (now_ >= until) break;  // what is due at `until` belongs to the next run
        for (UartLine& line : lines_)
            if (line.due() <= now_) line.deliver();
        if (master_ && master_->due() <= now_) master_->begin();
    }
    return End::Time;
}

void Bench::poll() {
    if (paced_) wait_for_wall_clock();
    for (UartLine& line : lines_)
        line.poll(now_);
    if (master_) master_->poll(now_);
    if (paced_ && logs_) logs_->flush();
}

void Bench::wait_for_wall_clock() {
    const std::int64_t ahead = now_ / cosim::kNanosecond - (wall_nanoseconds() - wall_origin_ns_);
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(ahead));
    // What is lost beyond this stays lost: a partner outside would see a robot that hurries.
    const std::int64_t lost = -ahead - kMostBehind / cosim::kNanosecond;
    if (lost <= 0) return;
    wall_origin_ns_ += lost;
    fallen_behind_ += lost * cosim::kNanosecond;
}

void Bench::apply_stimulus() {
    for (; next_stimulus_ < stimulus_.size() && stimulus_[next_stimulus_].time <= now_; ++next_stimulus_) {
        const StimulusLine& line = stimulus_[next_stimulus_];
        if (line.signal == StimulusLine::kReset) {
            press_reset();
            continue;
        }
        target_->set_signal(line.signal, line.value);
        signal_changed(target_->signals()[line.signal].name, line.value, now_);
    }
}

void Bench::press_reset() {
    target_->reset_button();
    signal_changed("reset", 1.0, now_);
}

void Bench::finish() {
    for (UartLine& line : lines_) {
        line.poll(now_);
        if (line.end() != nullptr) line.end()->finish();
    }
    target_->finish();
    if (logs_) logs_->flush();
    if (speaker_) speaker_->close();
}

void Bench::master(std::vector<I2cScriptLine> script, const I2cMasterOptions& options) {
    master_.emplace(std::move(script), options, *target_, logs_.get());
}

void Bench::i2c_answered(const cosim::I2cPhase& answer, cosim::Time time) {
    if (master_) master_->answered(answer, time);
}

void Bench::uart_sent(int unit, const cosim::UartFrame& frame) {
    uart(unit).sent(frame);
}

void Bench::i2c_phase(int unit, const cosim::I2cPhase& phase) {
    if (logs_) logs_->i2c(unit, phase);
}

void Bench::pin_changed(std::string_view pin, std::string_view function, std::optional<bool> level,
                        cosim::Time time) {
    if (logs_) logs_->pin(time, pin, function, !level ? "z" : *level ? "1" : "0");
    if (on_change) on_change(pin, function, level.value_or(false) ? 1 : 0, time);
}

void Bench::sound_sample(double value, cosim::Time time) {
    if (speaker_) speaker_->sample(value, time);
}

void Bench::signal_changed(std::string_view name, double value, cosim::Time time) {
    if (logs_) logs_->pin(time, "", name, fmt::format("{}", value));
    if (on_change) on_change("", name, value, time);
}

}  // namespace puckloop::exec
