// The first dialogue with the module. TAM fact sheet, section 9.

#include "linuxboard/coordinator/coordinator.h"

#include <fmt/format.h>

namespace puckloop::coordinator {

using protocols::XBeeBytes;

namespace {

constexpr double kStepTimeout = 5.0;  // s
constexpr int kTries = 5;             // within it: the first may meet a module that is still starting
constexpr double kWindowUnit = 0.1;   // s, of NT
constexpr double kLongestWindow = 60;
constexpr std::uint64_t kEscapedMode = 2;

std::uint64_t number_of(const XBeeBytes& bytes) {
    std::uint64_t number = 0;
    for (const std::uint8_t byte : bytes)
        number = number << 8 | byte;
    return number;
}

}  // namespace

/// The value of the module's answer; nothing if the program is to end.
std::optional<XBeeBytes> Coordinator::step(int number, std::string_view command, std::string_view asked,
                                           XBeeBytes value) {
    const auto fail = [&](const std::string& what) {
        throw ModuleError(
            fmt::format("{}: start-up step {}, {} ({}): {}", settings_.port, number, command, asked, what));
    };
    std::optional<protocols::XBeeAtResponse> answer;
    for (int i = 0; i < kTries && !answer; ++i) {
        answer = module_.ask(command, value, module_.now() + kStepTimeout / kTries, ended_);
        if (ended_()) return std::nullopt;
    }
    if (!answer)
        fail(fmt::format("no answer within {:g} s (expected an XBee module in API mode at 9600 baud; {} "
                         "bytes came, {} sound frames)",
                         kStepTimeout, counters().bytes, counters().frames));
    if (failed(*answer)) fail(fmt::format("the module answers with status {}", answer->status));
    note("module", std::string(command),
         answer->value.empty() ? "ok" : fmt::format("{:02x}", fmt::join(answer->value, "")));
    return answer->value;
}

/// False if the program is to end.
bool Coordinator::start_up() {
    const std::optional<XBeeBytes> mode = step(1, "AP", "the API mode");
    if (!mode) return false;
    if (number_of(*mode) != kEscapedMode && !step(1, "AP", "set API mode 2", {kEscapedMode})) return false;
    const std::optional<XBeeBytes> hardware = step(2, "HV", "the hardware");
    if (!hardware) return false;
    const bool series1 = !hardware->empty() && (hardware->front() == 0x17 || hardware->front() == 0x18);
    if (!series1) note("warning", "hardware", "not an XBee of Series 1 (17 or 18)");
    if (!step(3, "VR", "the firmware")) return false;
    const std::optional<XBeeBytes> window = step(4, "NT", "the time for discoveries");
    if (!window) return false;
    window_ = kWindowUnit * static_cast<double>(number_of(*window));
    if (window_ <= 0 || window_ > kLongestWindow)
        throw ModuleError(fmt::format("{}: start-up step 4, NT (the time for discoveries): {:g} s (expected "
                                      "0.1 s to 60 s)",
                                      settings_.port, window_));
    return true;
}

}  // namespace puckloop::coordinator
