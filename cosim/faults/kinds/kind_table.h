#pragma once
// What kinds of faults there are: where each can sit and which parameters it takes. One table serves the
// reader of scenarios, the command line and who carries the faults out.

#include "cosim/faults/spec/fault_kind.h"
#include "cosim/faults/spec/fault_spec.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::cosim {

/// What a fault sits on. Radio: a module's way to the air; Xbee: the air between modules.
enum class PlaceKind : std::uint8_t {
    Uart,
    Radio,
    I2c,
    InfraRed,
    Pic,
    Rab,
    Tam,
    Linux,
    Xbee,
    Ircom,
    Can,
    Network
};

enum class Unit : std::uint8_t {
    Time,
    Ratio,
    Number,
    Integer,
    Voltage,
    Frequency,
    Degrees,
    Flag,
    Byte,
    Text
};

struct ParameterInfo {
    std::string_view key;
    Unit unit = Unit::Number;
    double low = 0.0, high = 0.0;      ///< inclusive; times in seconds; unused for Flag, Byte and Text
    std::optional<double> fallback{};  ///< where the key is absent
    bool required = false;             ///< without fallback: absent means "the kind draws or decides"
    std::string_view choices{};        ///< Text: "low|high", the first is the fallback; empty: any text
};

/// How a kind meets the trigger; decides which of the keys of "when" it takes.
enum class Style : std::uint8_t {
    Each,   ///< candidates suffer one by one: probability, burst, skip, every, count, what matches
    Hold,   ///< holds during the window
    Times,  ///< happens at instants: `at`, or `begin` and then each `period`
};

struct KindInfo {
    std::string_view name;
    PlaceKind place;
    Style style = Style::Each;
    FaultKind mark = FaultKind::None;  ///< on messages of a link
    std::vector<ParameterInfo> parameters{};
    std::string_view alias{};  ///< what netem or others call it
};

/// Every kind of every place.
const std::vector<KindInfo>& all_kinds();
/// By name or alias; nullptr if that place has no such kind.
const KindInfo* find_kind(std::string_view name, PlaceKind place);
/// "drop, flip, ...": what can happen to such a place.
std::string kinds_of(PlaceKind place);

/// Adds what is not given and has a fallback.
void complete(FaultSpec& spec, const KindInfo& kind);
/// Throws InputError for what is out of range or does not belong to the kind; `spec` is complete.
void check_fault(const FaultSpec& spec, const KindInfo& kind);

// One function a family, in a file of its own.
std::vector<KindInfo> uart_kinds();
std::vector<KindInfo> radio_kinds();
std::vector<KindInfo> i2c_kinds();
std::vector<KindInfo> can_kinds();
std::vector<KindInfo> xbee_kinds();
std::vector<KindInfo> ircom_kinds();
std::vector<KindInfo> linux_kinds();
std::vector<KindInfo> board_kinds();
std::vector<KindInfo> network_kinds();
std::vector<KindInfo> infrared_kinds();
/// Throws InputError, without a place.
void check_board_fault(const FaultSpec& spec, const KindInfo& kind);
void check_uart_fault(const FaultSpec& spec, const KindInfo& kind);

}  // namespace puckloop::cosim
