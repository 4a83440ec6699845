// "NAME=NUMBER" of `gap record --set`: what is changed about the emulated robot, and which recordings show
// it.

#include "base/error.h"
#include "gap/data/experiment.h"
#include "gap/effects/effect.h"
#include "physics/description/parameters.h"
#include "selftest/emulate/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <stdexcept>

namespace puckloop::gap::emulate {

namespace {

/// What is no parameter of the world model.
struct Own {
    const char* name;
    double& (*place)(Robot&);
    double low, high;
    std::vector<std::string> shown_by;  ///< kinds whose rows hold what it does, beyond the times of rows
};

const std::vector<Own>& own_parameters() {
    static const std::vector<Own> all{
        {"board.crystal_ppm",
         [](Robot& r) -> double& { return r.crystal_ppm; },
         -1e4,
         1e4,
         {"motion", "serial"}},
        {"host.period", [](Robot& r) -> double& { return r.period; }, 0.01, 10.0, {"timing"}},
        {"tracker.exposure", [](Robot& r) -> double& { return r.tracker_exposure; }, 0.0, 1.0, {"motion"}},
        {"host.rab_poll", [](Robot& r) -> double& { return r.rab_poll; }, 0.0, 10.0, {"rab"}},
        {"uart.factor", [](Robot& r) -> double& { return r.uart_factor; }, 0.5, 2.0, {"timing"}},
        {"uart.loss", [](Robot& r) -> double& { return r.uart_loss; }, 0.0, 1.0, {"timing"}},
        {"uart.delay", [](Robot& r) -> double& { return r.uart_delay; }, 0.0, 10.0, {"motion"}},
        {"uart.cut", [](Robot& r) -> double& { return r.uart_cut; }, 0.0, 1.0, {"timing"}},
        {"uart.cut_again", [](Robot& r) -> double& { return r.uart_cut_again; }, 0.0, 1.0, {"timing"}},
        {"uart.edge_loss", [](Robot& r) -> double& { return r.uart_edge_loss; }, 0.0, 1.0, {"timing"}},
        {"linux.tty_batch", [](Robot& r) -> double& { return r.lateness.tty_batch; }, 0.0, 1.0, {"timing"}},
        {"linux.i2c_hold", [](Robot& r) -> double& { return r.lateness.i2c_hold; }, 0.0, 1.0, {"timing"}},
        {"linux.oversleep", [](Robot& r) -> double& { return r.lateness.oversleep; }, -1.0, 1.0, {"timing"}},
        {"linux.oversleep_jitter",
         [](Robot& r) -> double& { return r.lateness.oversleep_jitter; },
         0.0,
         1.0,
         {"timing"}},
    };
    return all;
}

std::string_view group_of(std::string_view name) {
    return name.substr(0, name.find('.'));
}

/// The parameters of the world model that a sentence names: "ground.x, y*" and "a.b_left and _right" too.
std::set<std::string> named_in(std::string_view text) {
    constexpr std::string_view kOfName = "abcdefghijklmnopqrstuvwxyz0123456789_.";
    std::set<std::string> names;
    std::string last;
    for (std::size_t at = 0; (at = text.find_first_of(kOfName, at)) != std::string_view::npos;) {
        const std::size_t end = std::min(text.find_first_not_of(kOfName, at), text.size());
        std::string word(text.substr(at, end - at));
        at = end;
        if (word.starts_with('_')) word = last.substr(0, last.rfind('_')) + word;
        if (word.find('.') == std::string::npos) word = std::string(group_of(last)) + "." + word;
        int index = -1;
        const auto* info = physics::find_parameter(word, index);
        if (info == nullptr) continue;
        names.insert(info->name);
        last = info->name;
    }
    return names;
}

}  // namespace

std::vector<std::string> kinds_showing(std::string_view name) {
    for (const Own& own : own_parameters())
        if (name == own.name) return own.shown_by;
    int index = -1;
    const auto* info = physics::find_parameter(name, index);
    if (info == nullptr) return {};
    std::set<std::string> kinds;
    const std::string_view group = group_of(info->name);
    for (const std::string& kind : recordable_kinds())
        if (group == kind || (group == "ir" && kind == "rab")) return {kind};
    if (group == "world") return {};  // a table's slope is felt by several kinds, as no effect of theirs
    for (const Effect& effect : catalogue())
        if (named_in(effect.enters).contains(info->name))
            for (const Kind kind : effect.kinds)
                kinds.insert(std::string(kind_name(kind)));
    return {kinds.begin(), kinds.end()};
}

void set_parameter(Robot& robot, const std::string& assignment) {
    const auto equals = assignment.find('=');
    char* end = nullptr;
    const double value =
        equals == std::string::npos ? 0.0 : std::strtod(assignment.c_str() + equals + 1, &end);
    if (equals == std::string::npos || end == assignment.c_str() + equals + 1 || *end != '\0')
        throw InputError("", "--set", fmt::format("'{}' is not an assignment", assignment),
                         "PARAMETER=NUMBER");
    const std::string name = assignment.substr(0, equals);
    std::string names;
    for (const Own& known : own_parameters())
        names += fmt::format(", {}", known.name);
    for (const Own& known : own_parameters())
        if (name == known.name) {
            if (!(value >= known.low && value <= known.high))
                throw InputError("", "--set " + assignment, "is out of range",
                                 fmt::format("{:g} to {:g}", known.low, known.high));
            known.place(robot) = value;
            return;
        }
    try {
        physics::Parameters().set(name, value);
    } catch (const std::invalid_argument& error) {
        throw InputError("", "--set " + assignment, error.what(),
                         "a parameter of `puckloop run --list-parameters`" + names);
    }
    robot.parameters[name] = value;
}

}  // namespace puckloop::gap::emulate
