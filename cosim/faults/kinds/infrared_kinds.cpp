// What can happen to the light between range-and-bearing boards; physics/ir/ir_faults carries it out.

#include "cosim/faults/kinds/kind_table.h"

namespace puckloop::cosim {

namespace {

constexpr double kParts = 12, kMostGain = 100, kMostCounts = 4095, kCircle = 360, kMostChips = 10'000,
                 kMostJitter = 1e-3;

ParameterInfo part(std::string_view key) {
    return {.key = key, .unit = Unit::Integer, .low = 0, .high = kParts, .fallback = 0.0};
}
ParameterInfo ratio(std::string_view key, double high, std::optional<double> fallback) {
    return {
        .key = key, .unit = Unit::Ratio, .low = 0, .high = high, .fallback = fallback, .required = !fallback};
}

}  // namespace

std::vector<KindInfo> infrared_kinds() {
    const PlaceKind ir = PlaceKind::InfraRed;
    const auto none = FaultKind::None;
    return {
        {"weak_emitter", ir, Style::Each, none, {part("emitter"), ratio("gain", kMostGain, std::nullopt)}},
        {"weak_receiver", ir, Style::Each, none, {part("receiver"), ratio("gain", kMostGain, std::nullopt)}},
        {"occlusion",
         ir,
         Style::Each,
         none,
         {{.key = "other", .unit = Unit::Text},
          {.key = "bearing", .unit = Unit::Degrees, .low = -kCircle, .high = kCircle},
          {.key = "width", .unit = Unit::Degrees, .low = 0, .high = kCircle},
          ratio("gain", 1, 0.0)}},
        {"ambient_burst",
         ir,
         Style::Hold,
         none,
         {part("receiver"),
          {.key = "level", .unit = Unit::Number, .low = 0, .high = kMostCounts, .fallback = kMostCounts},
          ratio("gain", 1, 0.0)}},
        {"chip_flip",
         ir,
         Style::Each,
         none,
         {{.key = "chip", .unit = Unit::Integer, .low = 0, .high = kMostChips}}},
        {"chip_jitter",
         ir,
         Style::Each,
         none,
         {{.key = "jitter", .unit = Unit::Time, .low = 0, .high = kMostJitter, .required = true}}},
    };
}

}  // namespace puckloop::cosim
