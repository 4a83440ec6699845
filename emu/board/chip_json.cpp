#include "emu/board/chip_json.h"

#include "base/json.h"
#include "emu/board/chip_warnings.h"
#include "emu/board/place_json.h"

#include <fmt/format.h>

namespace puckloop::board {

namespace {
std::string hexadecimal(std::uint32_t address) {
    return fmt::format("0x{:04x}", address);
}
}  // namespace

nlohmann::ordered_json chip_json(const dspic::Chip& chip) {
    using Json = nlohmann::ordered_json;
    const dspic::ChipReport report = chip.report();
    const auto seconds = [&](dspic::Cycle cycle) {
        return static_cast<double>(chip.clock().time_of(cycle)) / static_cast<double>(cosim::kSecond);
    };
    Json json;
    json["cycles"] = report.cycles;
    json["instructions"] = report.instructions;
    json["resets"] = Json::array();
    for (const dspic::ResetRecord& reset : report.resets)
        json["resets"].push_back(with_place(
            {{"time_s", seconds(reset.cycle)}, {"cause", reset.cause}, {"pc", hexadecimal(reset.pc)}},
            chip.places(), reset.pc));
    json["traps"] = Json::array();
    for (const dspic::TrapRecord& trap : report.traps)
        json["traps"].push_back(
            with_place({{"time_s", seconds(trap.cycle)}, {"name", trap.name}, {"pc", hexadecimal(trap.pc)}},
                       chip.places(), trap.pc));
    json["unmodelled"] = Json::array();
    for (const dspic::UnmodelledTouch& touch : report.unmodelled)
        json["unmodelled"].push_back({{"name", touch.name},
                                      {"address", hexadecimal(touch.address)},
                                      {"pc", hexadecimal(touch.pc)},
                                      {"access", touch.write ? "write" : "read"},
                                      {"time_s", seconds(touch.cycle)}});
    if (const std::optional<dspic::WaitReport> wait = chip.waiting()) {
        json["waiting"] = {{"since_s", seconds(wait->since)}, {"hung", wait->hung}};
        if (!wait->asleep) json["waiting"]["loop"] = {hexadecimal(wait->first), hexadecimal(wait->last)};
        json["waiting"]["text"] = *waiting_text(chip, wait);
    }
    json["refused_addresses"] = Json::array();
    for (const dspic::RefusedAddress& refused : report.refused_addresses)
        json["refused_addresses"].push_back({{"module", refused.unit},
                                             {"address", fmt::format("0x{:02x}", refused.address)},
                                             {"times", refused.times}});
    json["warnings"] = chip_warnings(chip);
    return json;
}

nlohmann::ordered_json uart_json(const dspic::UartCounters& counters) {
    return {{"sent", counters.sent},
            {"received", counters.received},
            {"framing_errors", counters.framing_errors},
            {"parity_errors", counters.parity_errors},
            {"overruns", counters.overruns}};
}

}  // namespace puckloop::board
