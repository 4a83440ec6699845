#include "gap/residuals/main_covariates.h"

#include "gap/kinds/columns.h"
#include "gap/residuals/residual_structure.h"

#include <fmt/format.h>

#include <map>
#include <set>

namespace puckloop::gap {

namespace {

using stats::Covariate;

constexpr std::size_t kMost = 3;

/// In the order of importance.
std::vector<std::string> wanted(const Kind& kind, const std::string& observable) {
    static const std::vector<std::string> kBearing{"true bearing", "distance", "receiver"};
    static const std::map<Kind::Builtin, std::vector<std::string>> kOfKind{
        {Kind::Proximity, {"distance", "angle", "sensor"}},
        {Kind::Rab, {"distance", "true bearing", "senders"}},
        {Kind::Microphone, {"distance", "angle", "mic"}},
        {Kind::Ground, {"grey", "time", "sensor"}},
        {Kind::Accelerometer, {"time", "pitch", "roll"}},
        {Kind::Timing, {"seq", "bytes", "load"}},
        {Kind::Motion, {"distance so far", "wheel speed", "turn rate", "time"}}};
    if (kind == Kind::Described) {  // what its user put first, what is true before what was set up
        std::vector<std::string> names;
        for (const Role role : {Role::Truth, Role::Stimulus, Role::Covariate})
            for (const ColumnInfo& column : columns_of(kind))
                if (column.role == role) names.push_back(plain_name(column.name));
        return names;
    }
    return observable == "bearing" ? kBearing : kOfKind.at(kind);
}

}  // namespace

std::vector<Covariate> main_covariates(const Experiment& experiment, const std::string& observable,
                                       const std::vector<Covariate>& all,
                                       const std::vector<std::uint32_t>& row) {
    std::vector<Covariate> found;
    for (const std::string& name : wanted(experiment.kind, observable))
        for (const Covariate& one : all)
            if (one.name == name && found.size() < kMost) found.push_back(one);
    if (found.empty()) found.push_back({"row", stats::CovariateKind::Number, {row.begin(), row.end()}, {}});
    return found;
}

std::string with_unit(const std::string& name, const std::string& unit) {
    return unit.empty() || unit == "1" ? name : fmt::format("{} ({})", name, unit);
}

std::string covariate_label(const std::string& name) {
    static const std::map<std::string, std::set<std::string>> kOfUnit{
        {"m", {"distance"}},
        {"rad", {"angle", "off axis", "true bearing", "theta", "pitch", "roll"}},
        {"s", {"time", "frame time", "poll period"}},
        {"m/s", {"velocity", "speed"}},
        {"steps", {"distance so far"}},
        {"steps/s", {"wheel speed", "turn rate", "cmd left", "cmd right", "motor speed"}},
        {"steps/s²", {"acceleration"}},
        {"°C", {"temperature"}},
        {"V", {"battery"}},
        {"1/m", {"grey rate"}}};
    for (const auto& [unit, names] : kOfUnit)
        if (names.contains(name)) return with_unit(name, unit);
    return name;
}

}  // namespace puckloop::gap
