// How a program comes to its end: by itself, with the run, or because it would not.

#include "base/json.h"
#include "linuxboard/shim/node/linux_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>
#include <string_view>
#include <utility>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;

namespace {
constexpr std::size_t kMostWarnings = 100;
constexpr std::string_view kAtTheEnd = " at the end of the run";
/// For what is left of a program once those of its processes that handle the end signal have ended.
constexpr Time kRestPause = 100 * cosim::kMillisecond;
/// So often it is looked whether the first process is still there.
constexpr Time kLookPause = 10 * cosim::kMillisecond;

std::string signal_name(int signal) {
    const char* name = sigabbrev_np(signal);
    return name != nullptr ? fmt::format("SIG{}", name) : fmt::format("signal {}", signal);
}
}  // namespace

void LinuxNode::warn(std::string line) {
    if (std::find(warnings_.begin(), warnings_.end(), line) != warnings_.end()) return;
    if (warnings_.size() < kMostWarnings) warnings_.push_back(std::move(line));
}

void LinuxNode::end_run(Time now, bool success, std::string reason, std::uint32_t programs) {
    if (!stop_) stop_ = cosim::Stop{now, success, std::move(reason), programs};
}

/// Others of the program's processes go on: what became of it then is known only when they have ended, and
/// where the run is over before that its end was nobody's doing but the signal's.
void LinuxNode::first_ended(Time now) {
    const bool asked = end_signal_ != 0 && killed_by_ == end_signal_;
    if (killed_by_ == 0 || asked) return;
    first_killed_ = first_gone_at_
                        ? fmt::format("its first process {}, noticed at {:.6f} s", end_,
                                      cosim::to_seconds(*first_gone_at_))
                        : fmt::format("its first process {} at {:.6f} s", end_, cosim::to_seconds(now));
    warn(fmt::format("{}: {}, and {} more went on", spec_.program, first_killed_, clients_.size()));
}

/// One that waits for simulated time and is killed from outside of it is not heard of before it would go on.
/// Only then is it taken out: what it may have woken by its end was not announced any earlier.
void LinuxNode::look_at_first(Time now) {
    if (now < next_look_) return;
    next_look_ = now + kLookPause;
    const Client* first = client_at(0);
    if (!first_gone_at_ && first != nullptr && first->process->was_killed()) first_gone_at_ = now;
}

void LinuxNode::notice_first_killed(Time now) {
    next_look_ = 0;
    look_at_first(now);
    Client* first = client_at(0);
    if (first != nullptr && first_gone_at_) client_ended(*first, now);
}

/// How the program ended, and that its first process had been killed before.
std::string LinuxNode::with_first_killed(std::string how) const {
    return first_killed_.empty() ? how : fmt::format("{}; {}", how, first_killed_);
}

void LinuxNode::program_ended(Time now) {
    kernel_.reset(std::max(now, begun_));
    if (end_signal_ != 0) return ended_winding_up(now);
    const bool comes_back = next_restart_ < spec_.restarts.size() || faults_.restarts_after(now);
    std::string reason = fmt::format("{} {}", spec_.program, end_);
    if (first_gone_at_) reason += fmt::format(", noticed at {:.6f} s", cosim::to_seconds(*first_gone_at_));
    const bool opened = has_no_devices() || used_a_device();
    if (!opened) {
        reason += spec_.tty.empty() ? " without opening its I2C bus"
                                    : fmt::format(" without ever opening {}", spec_.tty);
    }
    if (!ended_well_ || !opened) {
        if (const std::string last = launcher_->last_line(); !last.empty())
            reason += "; its last line: " + last;
    }
    const std::string at = fmt::format(" (at {:.6f} s)", cosim::to_seconds(now));
    if (comes_back) {
        warn(reason + at);
    } else if (spec_.exit_ends_run || !ended_well_) {
        const bool well = ended_well_ && opened;
        end_run(now, well, reason, well ? spec_.programs : 1);
    } else if (!has_no_devices()) {
        warn(reason + at);
    }
}

std::string LinuxNode::last_words() const {
    if (spec_.log.empty()) return "its output is not kept";
    const std::string line = launcher_->last_line();
    return line.empty() ? "it printed nothing" : line;
}

bool LinuxNode::used_a_device() const {
    return kernel_.tty_was_opened() || kernel_.i2c_was_opened() || kernel_.camera_was_opened() ||
           kernel_.network_was_used();
}

/// A computer on the network: nothing is missed if its program opens none.
bool LinuxNode::has_no_devices() const {
    return spec_.tty.empty() && spec_.i2c.empty() && spec_.cameras.empty() && spec_.network.has_value();
}

void LinuxNode::note_devices() {
    never_opened_ = !used_a_device() && !has_no_devices();
    if (!kernel_.tty_was_opened() && !kernel_.camera_was_opened() && !kernel_.network_was_used() &&
        !spec_.tty.empty())
        warn(fmt::format("{} never opened {}", spec_.program, spec_.tty));
}

/// With the run nothing waits for the serial port any more.
void LinuxNode::end_leaving(Time now) {
    for (bool found = true; std::exchange(found, false);) {
        for (const auto& client : clients_) {
            if (!client->leaving) continue;
            client_ended(*client, now);
            found = true;
            break;
        }
    }
}

/// A program that waits for what never comes looks like one that has nothing to do.
void LinuxNode::note_waiting(Time now) {
    constexpr Time kLong = 5 * cosim::kSecond;
    const std::optional<Time> since = kernel_.waits_for_bytes_since();
    if (!since || now - *since < kLong) return;
    warn(fmt::format(
        "{} has waited for bytes at its serial port since {:.6f} s, up to the run's end at {:.6f} s",
        spec_.program, cosim::to_seconds(*since), cosim::to_seconds(now)));
}

void LinuxNode::wind_up(Time now, int signal) {
    action_.reset();
    notice_first_killed(now);
    end_leaving(now);
    start_at_ = kNever;
    next_restart_ = spec_.restarts.size();
    end_signal_ = signal != 0 ? signal : spec_.end_signal;
    if (clients_.empty()) return;
    note_waiting(now);
    note_devices();
    const bool die = std::all_of(clients_.begin(), clients_.end(), [this](const auto& client) {
        return client->process->dies_of(end_signal_);
    });
    if (die) {
        kill_all(now);
        end_ = with_first_killed("was ended with the run");
        return;
    }
    end_signal_at_ = now;
    kill_at_ = now + spec_.grace;
    wound_up_ = kNever;
}

/// First to the processes that handle it. A shell or a `tee` that would only die of it has the rest of the
/// program's output to take, and gets it once those have ended.
void LinuxNode::send_end_signal(Time now) {
    end_signal_at_ = kNever;
    if (std::exchange(end_signal_sent_, true)) return signal_all(end_signal_, now);
    for (const auto& client : clients_) {
        if (client->process->dies_of(end_signal_)) continue;
        client->end_signalled = true;
        send_signal(client->slot, end_signal_, now);
    }
}

void LinuxNode::signalled_ended(Time now) {
    const bool more = std::any_of(clients_.begin(), clients_.end(),
                                  [](const auto& client) { return client->end_signalled; });
    if (!more && !clients_.empty()) end_signal_at_ = std::min(kill_at_, now + kRestPause);
}

void LinuxNode::ended_winding_up(Time now) {
    kill_at_ = end_signal_at_ = kNever;
    wound_up_ = now;
    const std::string how = fmt::format("{} after {}{}", end_, signal_name(end_signal_), kAtTheEnd);
    if (crashed_) return end_run(now, false, fmt::format("{} {}", spec_.program, how), 1);
    if (!ended_well_ && killed_by_ != end_signal_)
        warn(fmt::format("{} {} (at {:.6f} s)", spec_.program, how, cosim::to_seconds(now)));
    end_ = how;
}

void LinuxNode::out_of_grace(Time now) {
    kill_at_ = end_signal_at_ = kNever;
    wound_up_ = now;
    kill_all(now);
    end_ = with_first_killed(fmt::format("was killed: it had not ended {:g} s after {}",
                                         cosim::to_seconds(spec_.grace), signal_name(end_signal_)));
    warn(fmt::format("{} {}", spec_.program, end_));
}

std::string LinuxNode::finish() {
    if (starts_ == 0) end_ = "was not started: the run ended before its time";
    notice_first_killed(until_);
    end_leaving(until_);
    if (!clients_.empty()) {
        note_devices();
        end_ = with_first_killed("was ended with the run");
        kill_all(until_);
    }
    const wire::TtyCounters tty = kernel_.tty().counters();
    nlohmann::ordered_json report = {
        {"program", spec_.program},
        {"end", end_},
        // By itself, behind the end signal, with a status or by another signal than that.
        {"ended_badly", end_.ends_with(kAtTheEnd) && !ended_well_ && killed_by_ != end_signal_},
        {"never_opened_a_device", never_opened_},
        {"starts", starts_},
        {"processes", processes_},
        {"requests", requests_},
        {"answered_by_library", answered_by_library_},
        {"log", spec_.log},
        {"clock",
         {{"error_ppm", spec_.system_clock_ppm},
          {"oversleep_s", cosim::to_seconds(spec_.oversleep.mean)},
          {"oversleep_jitter_s", cosim::to_seconds(spec_.oversleep.jitter)}}},
        {"uart",
         {{"received", tty.received},
          {"sent", tty.sent},
          {"framing_errors", tty.framing},
          {"parity_errors", tty.parity},
          {"breaks", tty.breaks},
          {"buffer_overruns", tty.buffer_overrun}}},
        {"i2c", {{"transfers", kernel_.adapter().transfers()}, {"failed", kernel_.adapter().failures()}}},
    };
    for (const auto& camera : kernel_.cameras()) {
        report["cameras"].push_back(nlohmann::ordered_json::parse(camera->report()));
        for (std::string& line : camera->take_unknown())
            warn(std::move(line));
    }
    if (const NetworkStack* network = kernel_.network()) {
        report["network"] = nlohmann::ordered_json::parse(network->report());
        for (const std::string& name : network->unknown_names())
            warn(fmt::format("no computer of the network has the name '{}'", name));
    }
    report["warnings"] = warnings_;
    if (!faults_.empty()) report["faults"] = cosim::fault_results(faults_.carried(), until_);
    return report.dump();
}

}  // namespace puckloop::linuxboard
