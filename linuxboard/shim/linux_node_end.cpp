// How a program comes to its end: by itself, with the run, or because it would not.

#include "linuxboard/shim/linux_node.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <csignal>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;

namespace {
constexpr std::size_t kMostWarnings = 100;

std::string signal_name(int signal) {
    const char* name = sigabbrev_np(signal);
    return name != nullptr ? fmt::format("SIG{}", name) : fmt::format("signal {}", signal);
}
}  // namespace

void LinuxNode::warn(std::string line) {
    if (warnings_.size() < kMostWarnings) warnings_.push_back(std::move(line));
}

void LinuxNode::end_run(Time now, bool success, std::string reason, std::uint32_t programs) {
    if (!stop_) stop_ = cosim::Stop{now, success, std::move(reason), programs};
}

void LinuxNode::program_ended(Time now) {
    state_ = State::Off;
    kernel_.reset();
    end_ = process_->describe_end();
    if (end_signal_ != 0) return ended_winding_up(now);
    const bool comes_back = next_restart_ < spec_.restarts.size();
    std::string reason = fmt::format("{} {}", spec_.program, end_);
    const bool opened = kernel_.tty_was_opened() || kernel_.i2c_was_opened();
    if (!opened) {
        reason += spec_.tty.empty() ? " without opening its I2C bus"
                                    : fmt::format(" without ever opening {}", spec_.tty);
    }
    if (!process_->ended_well() || !opened) {
        if (const std::string last = process_->last_line(); !last.empty())
            reason += "; its last line: " + last;
    }
    const std::string at = fmt::format(" (at {:.6f} s)", cosim::to_seconds(now));
    if (comes_back) {
        warn(reason + at);
    } else if (spec_.exit_ends_run || !process_->ended_well()) {
        const bool well = process_->ended_well() && opened;
        end_run(now, well, reason, well ? spec_.programs : 1);
    } else {
        warn(reason + at);
    }
}

std::string LinuxNode::last_words() const {
    if (spec_.log.empty()) return "its output is not kept";
    const std::string line = process_->last_line();
    return line.empty() ? "it printed nothing" : line;
}

void LinuxNode::note_devices() {
    never_opened_ = !kernel_.tty_was_opened() && !kernel_.i2c_was_opened();
    if (!kernel_.tty_was_opened() && !spec_.tty.empty())
        warn(fmt::format("{} never opened {}", spec_.program, spec_.tty));
}

void LinuxNode::wind_up(Time now, int signal) {
    start_at_ = kNever;
    next_restart_ = spec_.restarts.size();
    end_signal_ = signal != 0 ? signal : spec_.end_signal;
    if (!process_->running()) return;
    note_devices();
    if (process_->dies_of(end_signal_)) {
        process_->kill();
        state_ = State::Off;
        kernel_.reset();
        end_ = "was ended with the run";
        return;
    }
    end_signal_at_ = now;
    kill_at_ = now + spec_.grace;
    wound_up_ = kNever;
}

void LinuxNode::ended_winding_up(Time now) {
    kill_at_ = end_signal_at_ = kNever;
    wound_up_ = now;
    const std::string how = fmt::format("{} after {} at the end of the run", end_, signal_name(end_signal_));
    if (process_->crashed()) return end_run(now, false, fmt::format("{} {}", spec_.program, how), 1);
    if (!process_->ended_well())
        warn(fmt::format("{} {} (at {:.6f} s)", spec_.program, how, cosim::to_seconds(now)));
    end_ = how;
}

void LinuxNode::out_of_grace(Time now) {
    kill_at_ = end_signal_at_ = kNever;
    wound_up_ = now;
    process_->kill();
    state_ = State::Off;
    kernel_.reset();
    end_ = fmt::format("was killed: it had not ended {:g} s after {}", cosim::to_seconds(spec_.grace),
                       signal_name(end_signal_));
    warn(fmt::format("{} {}", spec_.program, end_));
}

std::string LinuxNode::finish() {
    if (starts_ == 0) end_ = "was not started: the run ended before its time";
    if (process_->running()) {
        note_devices();
        end_ = "was ended with the run";
        process_->kill();
    }
    const wire::TtyCounters tty = kernel_.tty().counters();
    nlohmann::ordered_json report = {
        {"program", spec_.program},
        {"end", end_},
        {"never_opened_a_device", never_opened_},
        {"starts", starts_},
        {"requests", requests_},
        {"log", spec_.log},
        {"uart",
         {{"received", tty.received},
          {"sent", tty.sent},
          {"framing_errors", tty.framing},
          {"parity_errors", tty.parity},
          {"breaks", tty.breaks},
          {"buffer_overruns", tty.buffer_overrun}}},
        {"i2c", {{"transfers", kernel_.adapter().transfers()}, {"failed", kernel_.adapter().failures()}}},
        {"warnings", warnings_},
    };
    return report.dump();
}

}  // namespace puckloop::linuxboard
