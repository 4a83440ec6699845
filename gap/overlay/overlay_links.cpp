// Deviations: 1. a longer, shorter or unsteady period is that of sleeps which end late or early; a program
// that sleeps until a time, not for a time, keeps its period. 2. Commands are lost byte by byte, each with
// the share that makes the found share of records.

#include "gap/overlay/overlay_parts.h"

#include "protocols/serial/epuck_serial.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace puckloop::gap {

namespace {

/// s from a command's row to the wheels that a run has by itself: a record on the line and the firmware's
/// loop (as selftest/emulate records it). Measured latencies hold it, too; it must not be there twice.
constexpr double kOwnCommandLatency = 0.0033;

class LinksOverlay {
  public:
    LinksOverlay(const Values& nominal, Values& fitted) : nominal_(nominal), fitted_(fitted) {}

    std::string text() {
        table("uart");
        if (const auto late = more("command.latency", kOwnCommandLatency))
            line("command_delay", fmt::format("\"{:.9g} s\"", *late));
        if (const auto lost = more("command.loss")) {
            // As many as in the long run, each by itself. A record is lost with any of its bytes.
            const auto burst = more("command.loss_burst");
            if (burst)
                header_ += fmt::format("# {:.3g} of command.loss_burst was found; a run loses as many, not "
                                       "one after another\n",
                                       *burst);
            const double all = *lost / (1 - burst.value_or(0.0) * (1 - *lost));
            share("command_loss", 1 - std::pow(1 - std::min(all, 0.999),
                                               1 / static_cast<double>(protocols::kEpuckActuatorBytes)));
        }
        if (const auto burst = fitted_.find("timing.truncation_burst");
            burst != fitted_.end() && burst->second < 0) {
            header_ +=
                fmt::format("# {:.3g} of truncation_burst was found; a run takes 0 to 1\n", burst->second);
            fitted_.erase(burst);
        }
        if (const auto cut = more("timing.truncation")) {
            share("answer_cut", *cut);
            share("answer_cut_again", more("timing.truncation_burst"));
        }
        share("answer_edge_loss", more("timing.edge_errors"));
        table("linux");
        seconds("timing.i2c_stretch", "i2c_hold");
        seconds("timing.batch", "tty_batch");
        seconds("timing.extra_period", "oversleep");
        seconds("timing.period_jitter", "oversleep_jitter");
        table("clock");
        if (const auto drift = more("timing.clock_drift")) {
            constexpr double kMost = 2e5;  // ppm, what a run takes
            const double ppm = (1 / (1 + *drift) - 1) * 1e6, taken = std::clamp(ppm, -kMost, kMost);
            if (taken != ppm)
                header_ += fmt::format("# {:.6g} ppm was found; a run takes -200000 to 200000\n", ppm);
            line("pic_error", fmt::format("\"{:.9g} ppm\"", taken));
        }
        return text_;
    }

  private:
    /// The fitted value over what a run makes by itself: the nominal one where the experiment states it, else
    /// `own`. Taken out if a run can have it; nothing where it is none.
    std::optional<double> more(const std::string& name, double own = 0.0) {
        const auto place = fitted_.find(name);
        if (place == fitted_.end()) return std::nullopt;
        const auto known = nominal_.find(name);
        const double value = place->second - (known == nominal_.end() ? own : known->second);
        const bool either_sign = name == "timing.clock_drift" || name == "timing.extra_period";
        if (!(value > 0) && !either_sign) return std::nullopt;
        fitted_.erase(place);
        return value == 0 ? std::nullopt : std::optional(value);
    }
    void table(const char* name) { header_ = fmt::format("\n[{}]\n", name); }
    void line(const char* key, const std::string& value) {
        text_ += header_ + fmt::format("{} = {}\n", key, value);
        header_.clear();
    }
    void seconds(const char* name, const char* key) {
        constexpr double kLongest = 1.0;  // what a run takes
        const auto found = more(name);
        if (!found) return;
        const double taken = std::clamp(*found, -kLongest, kLongest);
        if (taken != *found)
            header_ += fmt::format("# {} = {:.6g} s was found; a run takes -1 to 1 s\n", name, *found);
        line(key, fmt::format("\"{:.9g} s\"", taken));
    }
    void share(const char* key, std::optional<double> found) {
        if (found) line(key, fmt::format("{:.9g}", std::min(*found, 1.0)));
    }

    const Values& nominal_;
    Values& fitted_;
    std::string header_, text_;
};

}  // namespace

std::string links_overlay(const Values& nominal, Values& fitted) {
    return LinksOverlay(nominal, fitted).text();
}

}  // namespace puckloop::gap
