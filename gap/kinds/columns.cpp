#include "gap/kinds/columns.h"

#include "base/enum_names.h"
#include "base/error.h"
#include "base/text/suggest.h"
#include "gap/kinds/description.h"

#include <fmt/format.h>

#include <array>
#include <map>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kAny = 1e12;

using enum Role;

// The last two numbers, where there are any, are what is usual. Rows come each minute or oftener. Range and
// bearing: heard to 0.8 m, in published sets to 6 m; frames of 4.5 and 9.2 ms. An edge of a printed floor
// under a spot of millimetres: up to some 1000 / m. The e-puck drives 0.13 m/s, weighs 0.2 kg and has one
// cell of 3.4 to 4.2 V. No angle that matters lies below 1.6 degrees, a whole circle's half below 3. Of
// shares some are more than a hundredth or two.
// clang-format off
const std::vector<ColumnInfo> kCommon{
    {"t_s", "s", Covariate, false, -kAny, kAny, "time since the run began", 2e-4, 60},
    {"order", "1", Covariate, false, -kAny, kAny, "place of the run or row in the order of measuring"},
    {"session", "1", Covariate, false, -kAny, kAny, "which session (power-up, day)"},
    {"unit", "1", Covariate, false, -kAny, kAny, "which robot"},
    {"temperature_c", "degC", Covariate, false, -40, 120, "temperature"},
    {"battery_v", "V", Covariate, false, 0, 30, "battery voltage", 1, 15},
    {"ambient", "1", Covariate, false, 0, 10, "ambient light: 0 dark, 1 lit room", 0, 10},
    {"neighbours", "1", Covariate, false, 0, 1000, "other robots that are switched on near by"},
    {"speed", "m/s", Covariate, false, -10, 10, "forward speed of the robot", 1e-4, 4},
    {"motor_speed", "steps/s", Covariate, false, -5000, 5000, "mean step rate of the two motors"},
};

const std::vector<ColumnInfo> kProximity{
    {"reading", "counts", Observable, true, -2000, 20000, "ambient minus lit counts"},
    {"distance_m", "m", Truth, true, -0.02, 1, "sensor to surface along the sensor's axis", 2e-4, 1},
    {"sensor", "1", Stimulus, false, 0, 7, "which of the eight; 0 if the column is absent"},
    {"angle_rad", "rad", Truth, false, -1.6, 1.6, "incidence: between the sensor's axis and the surface's normal", 0.028, 1.6},
    {"off_axis_rad", "rad", Truth, false, -3.2, 3.2, "direction of a narrow object (post, edge) off the sensor's nominal axis, + left", 0.028, 3.2},
    {"reflectivity", "1", Stimulus, false, 0, 3, "nominal, 1 = white paper", 0.02, 3},
    {"object", "1", Stimulus, false, 0, 1e6, "which object stands before the sensor"},
    {"velocity", "m/s", Stimulus, false, -1, 1, "rate of change of distance_m"},
    {"ambient_reading", "counts", Covariate, false, 0, 20000, "ambient counts (fall with light)"},
    {"pair_reading", "counts", Covariate, false, -2000, 20000, "reading of the sensor lit by the same pulse (i+4), same moment"},
    {"neighbour_reading", "counts", Covariate, false, -4000, 40000, "sum of the two neighbours' readings, same moment"},
};

const std::vector<ColumnInfo> kMotion{
    {"x_m", "m", Truth, true, -1000, 1000, "tracked position"},
    {"y_m", "m", Truth, true, -1000, 1000, "tracked position"},
    {"theta_rad", "rad", Truth, true, -1000, 1000, "tracked heading, counter-clockwise; wrapped or not"},
    {"steps_left", "1", Stimulus, false, -kAny, kAny, "the firmware's step counter (cumulative)"},
    {"steps_right", "1", Stimulus, false, -kAny, kAny, "as steps_left"},
    {"cmd_left", "steps/s", Stimulus, false, -5000, 5000, "commanded speed in force from this row on"},
    {"cmd_right", "steps/s", Stimulus, false, -5000, 5000, "as cmd_left"},
    {"load_kg", "kg", Covariate, false, 0, 10, "what the robot carries or pushes beyond itself", 1e-3, 5},
    {"incline_rad", "rad", Covariate, false, -0.5, 0.5, "upward slope of the floor along the heading", 0, 0.5},
};

const std::vector<ColumnInfo> kRab{
    {"distance_m", "m", Truth, true, 0, 20, "between the two boards' edges, as a ruler measures it", 0.02, 10},
    {"strength", "counts", Observable, false, 0, 20000, "received signal strength; missing when nothing was received"},
    {"bearing_rad", "rad", Observable, false, -7, 7, "bearing that the receiver gives"},
    {"received", "1", Observable, false, 0, 1, "1: this message arrived, 0: it did not"},
    {"valid", "1", Observable, false, 0, 1, "1: its payload was what had been sent, 0: wrong data; missing when not received"},
    {"true_bearing_rad", "rad", Truth, false, -7, 7, "true bearing of the sender in the receiver's frame"},
    {"sender_bearing_rad", "rad", Truth, false, -7, 7, "true bearing of the receiver in the sender's frame"},
    {"emitter", "1", Stimulus, false, 0, 12, "which emitter sent (1..12), 0 = all"},
    {"receiver", "1", Stimulus, false, 0, 12, "receiver nearest to the sender's direction (1..12)"},
    {"senders", "1", Stimulus, false, 0, 1000, "boards that were sending, this message's included"},
    {"frame_time", "s", Stimulus, false, 0, 1, "duration of one frame on the air", 3e-4, 0.1},
    {"send_period", "s", Stimulus, false, 0, 100, "period of each sender", 1e-3, 100},
    {"poll_period", "s", Stimulus, false, 0, 100, "period of the receiver's host polls", 1e-3, 60},
    {"arrival_rate", "Hz", Stimulus, false, 0, 10000, "messages a second on the air at this receiver; 0 where each was waited for"},
    {"occluded", "1", Stimulus, false, 0, 1, "1: a third body stands in the line"},
};

const std::vector<ColumnInfo> kMicrophone{
    {"level", "counts", Observable, true, 0, 20000, "volume: largest minus smallest sample of a window"},
    {"distance_m", "m", Truth, true, 0, 20, "to the loudspeaker", 0.01, 10},
    {"angle_rad", "rad", Truth, false, -7, 7, "direction of the loudspeaker off the microphone's axis", 0.055, 7},
    {"mic", "1", Stimulus, false, 0, 7, "which microphone; 0 if absent"},
    {"amplitude", "counts", Stimulus, false, 0, kAny, "level that the loudspeaker gives at 0.1 m on the axis"},
    {"window", "1", Stimulus, false, 1, 100000, "samples a level is taken from"},
};

const std::vector<ColumnInfo> kGround{
    {"reading", "counts", Observable, true, -100, 5000, "reflected counts"},
    {"grey", "1", Truth, true, -0.01, 1.5, "of the floor under the sensor: 0 black, 1 white", 0.02, 1.5},
    {"sensor", "1", Stimulus, false, 0, 2, "0 left, 1 centre, 2 right; 0 if absent"},
    {"grey_rate", "1/m", Truth, false, -1e4, 1e4, "change of grey a metre of travel along the heading", 1e-3, 3000},
    {"grey_across", "1/m", Truth, false, -1e4, 1e4, "change of grey a metre to the left"},
    {"pitch_rad", "rad", Truth, false, -0.5, 0.5, "nose up is positive"},
    {"acceleration", "m/s2", Stimulus, false, -50, 50, "forward"},
};

const std::vector<ColumnInfo> kAccelerometer{
    {"ax", "counts", Observable, true, -40000, 40000, "to the right"},
    {"ay", "counts", Observable, true, -40000, 40000, "to the rear"},
    {"az", "counts", Observable, true, -40000, 40000, "up"},
    {"pitch_rad", "rad", Truth, false, -3.2, 3.2, "nose up is positive; 0 if absent"},
    {"roll_rad", "rad", Truth, false, -3.2, 3.2, "left side up is positive; 0 if absent"},
    {"acceleration", "m/s2", Truth, false, -50, 50, "forward; 0 if absent"},
    {"lateral", "m/s2", Truth, false, -50, 50, "to the left; 0 if absent"},
};

const std::vector<ColumnInfo> kTiming{
    {"t_host_s", "s", Observable, true, -kAny, kAny, "host's clock when the frame arrived"},
    {"t_robot_s", "s", Truth, false, -kAny, kAny, "robot's clock when the frame was made"},
    {"seq", "1", Stimulus, false, 0, kAny, "number of the frame; the row's if absent"},
    {"nominal_period", "s", Stimulus, false, 0, 1000, "of the control loop; 0.1 if absent"},
    {"bytes", "1", Stimulus, false, 0, 100000, "on the line in this cycle, both directions"},
    {"edges", "1", Stimulus, false, 0, kAny, "bytes 0x00, 0xFF and the like with the longest runs in this frame"},
    {"frame_ok", "1", Observable, false, 0, 1, "1: the frame was whole and right"},
    {"shifted", "1", Observable, false, 0, 1, "1: fields were shifted by lost bytes (implausible values)"},
    {"i2c_reads", "1", Stimulus, false, 0, 10000, "I2C transfers in this cycle"},
    {"load", "1", Stimulus, false, 0, 1000, "share of time that the receiver's interrupts are blocked (analogue service, DISI)"},
    {"baud", "Hz", Stimulus, false, 1, 1e7, "of the line; 115200 if absent"},
};
// clang-format on

struct UnitInfo {
    const char* name;
    ToSi to_si;
};
constexpr double kDegree = std::numbers::pi / 180;
/// Units by the SI unit that they are turned into.
const std::map<std::string_view, std::vector<UnitInfo>> kUnits{
    {"m", {{"m", {1}}, {"cm", {0.01}}, {"mm", {0.001}}, {"um", {1e-6}}, {"in", {0.0254}}, {"km", {1000}}}},
    {"rad", {{"rad", {1}}, {"deg", {kDegree}}, {"turn", {2 * std::numbers::pi}}}},
    {"s", {{"s", {1}}, {"ms", {1e-3}}, {"us", {1e-6}}, {"ns", {1e-9}}, {"min", {60}}, {"h", {3600}}}},
    {"V", {{"V", {1}}, {"mV", {1e-3}}}},
    {"degC", {{"degC", {1}}, {"K", {1, -273.15}}, {"degF", {5.0 / 9, -32 * 5.0 / 9}}}},
    {"Hz", {{"Hz", {1}}, {"kHz", {1e3}}, {"MHz", {1e6}}, {"1/s", {1}}}},
    {"m/s", {{"m/s", {1}}, {"cm/s", {0.01}}, {"mm/s", {1e-3}}}},
    {"steps/s", {{"steps/s", {1}}}},
    {"m/s2", {{"m/s2", {1}}, {"g", {9.80665}}, {"mm/s2", {1e-3}}}},
    {"kg", {{"kg", {1}}, {"gram", {1e-3}}}},
    {"1/m", {{"1/m", {1}}, {"1/mm", {1e3}}, {"1/cm", {100}}}},
    {"rad/s", {{"rad/s", {1}}, {"deg/s", {kDegree}}, {"rpm", {2 * std::numbers::pi / 60}}}},
    {"A", {{"A", {1}}, {"mA", {1e-3}}, {"uA", {1e-6}}}},
    {"ohm", {{"ohm", {1}}, {"kohm", {1e3}}}},
    {"W", {{"W", {1}}, {"mW", {1e-3}}}},
    {"N", {{"N", {1}}, {"mN", {1e-3}}}},
    {"Pa", {{"Pa", {1}}, {"hPa", {100}}, {"kPa", {1e3}}, {"bar", {1e5}}}},
    {"T", {{"T", {1}}, {"mT", {1e-3}}, {"uT", {1e-6}}}},
    {"lx", {{"lx", {1}}}},
    {"counts", {{"counts", {1}}}},
    {"1", {{"1", {1}}, {"%", {0.01}}, {"steps", {1}}, {"", {1}}}},
};

std::vector<ColumnInfo> with_common(std::vector<ColumnInfo> own) {
    own.insert(own.end(), kCommon.begin(), kCommon.end());
    for (auto& column : own)
        if (std::string_view(column.name) == "t_s" && own.front().name == std::string_view("x_m"))
            column.required = true;  // motion without time is not motion
    return own;
}

constexpr std::array<std::string_view, 7> kNames{"proximity", "motion",        "rab",   "microphone",
                                                 "ground",    "accelerometer", "timing"};

}  // namespace

std::span<const ColumnInfo> columns_of(const Kind& kind) {
    static const std::array<std::vector<ColumnInfo>, 7> tables{
        with_common(kProximity), with_common(kMotion),        with_common(kRab),   with_common(kMicrophone),
        with_common(kGround),    with_common(kAccelerometer), with_common(kTiming)};
    if (const Description* own = kind.description()) return own->columns;
    return tables.at(kind);
}

std::span<const ColumnInfo> common_columns() {
    return kCommon;
}

const ColumnInfo* find_column(const Kind& kind, std::string_view name) {
    for (const ColumnInfo& column : columns_of(kind))
        if (column.name == name) return &column;
    return nullptr;
}

bool is_column_unit(std::string_view si) {
    return kUnits.contains(si);
}

std::optional<ToSi> unit_to_si(std::string_view unit, std::string_view si) {
    for (const auto& [to, units] : kUnits)
        for (const UnitInfo& known : units)
            if (unit == known.name && (si == to || (si == "counts" && to == "1"))) return known.to_si;
    return std::nullopt;
}

std::string unit_suffix(std::string_view unit) {
    if (unit.empty() || unit == "1") return "";
    return unit.starts_with("1/") ? fmt::format(" per {}", unit.substr(2)) : fmt::format(" {}", unit);
}

std::vector<std::string_view> unit_names(std::string_view si) {
    std::vector<std::string_view> names;
    for (const UnitInfo& unit : kUnits.at(si))
        if (*unit.name != '\0') names.emplace_back(unit.name);
    return names;
}

std::string_view kind_name(const Kind& kind) {
    if (const Description* own = kind.description()) return own->name;
    return kNames.at(kind);
}

bool is_builtin_kind(std::string_view name) {
    return value_named<Kind::Builtin>(kNames, name).has_value();
}

Kind kind_named(std::string_view name, std::string_view file, std::string_view place) {
    if (const auto kind = value_named<Kind::Builtin>(kNames, name)) return *kind;
    throw InputError(
        file, place,
        fmt::format("unknown kind \"{}\"{}", name, did_you_mean(name, {kNames.begin(), kNames.end()})),
        kKindNames);
}

}  // namespace puckloop::gap
