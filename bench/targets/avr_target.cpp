#include "bench/targets/avr_target.h"

#include "debug/debug_chip.h"

#include "base/json.h"
#include "emu/avr/chip/crash_text.h"
#include "emu/board/nvm_file.h"
#include "emu/board/place_json.h"

#include <fmt/format.h>

namespace puckloop::exec {

namespace {

constexpr std::size_t kShownOfAvr = 10;
constexpr int kPinsOfAvrPort = 8;

std::string hexadecimal(std::uint32_t address) {
    return fmt::format("0x{:04x}", address);
}

}  // namespace

image::Image AvrTarget::read_image(const std::string& file, std::string_view) {
    firmware_ = image::load_avr_image(file, device_.image_part());
    use_fuses();
    image::Image image;
    image.file = firmware_.file;
    image.format = firmware_.format;
    image.sha256 = firmware_.sha256;
    image.chip = firmware_.chip;
    image.symbols = firmware_.symbols;
    return image;
}

void AvrTarget::use_fuses() {
    constexpr std::size_t kFuses = 3;
    if (fuses_.empty()) return;
    firmware_.fuses.assign(fuses_.begin(), fuses_.begin() + kFuses);
    if (fuses_.size() > kFuses) firmware_.lock_bits = fuses_[kFuses];
}

void AvrTarget::load_kept(const image::Image& image, const board::NvmFile& nvm) {
    if (nvm.contents()) {
        image::AvrImage kept = image::parse_avr_image(*nvm.contents(), nvm.path(), device_.image_part());
        firmware_.flash = std::move(kept.flash);
        firmware_.eeprom = std::move(kept.eeprom);
        firmware_.fuses = std::move(kept.fuses);
        firmware_.lock_bits = kept.lock_bits;
        use_fuses();
    }
    load(image);
}

void AvrTarget::save_memory(board::NvmFile& nvm) {
    nvm.save_contents(image::write_avr_hex(avr().memory()));
}

double AvrTarget::seconds(avr::Cycle cycle) {
    return static_cast<double>(avr().clock().time_of(cycle)) / static_cast<double>(cosim::kSecond);
}

void AvrTarget::show_pins(avr::PortLetter port, std::uint8_t levels, std::uint8_t driven, cosim::Time now,
                          std::string_view (*function_of)(avr::PortLetter port, int bit)) {
    auto& [old_levels, old_driven] = shown_[static_cast<std::size_t>(port)];
    const unsigned changed = (old_levels ^ levels) | (old_driven ^ driven);
    old_levels = levels;
    old_driven = driven;
    for (int pin = 0; pin < kPinsOfAvrPort; ++pin) {
        if ((changed >> pin & 1u) == 0) continue;
        std::optional<bool> level;
        if ((driven >> pin & 1u) != 0) level = (levels >> pin & 1u) != 0;
        listener_.pin_changed(fmt::format("P{}{}", static_cast<char>('A' + static_cast<int>(port)), pin),
                              function_of(port, pin), level, now);
    }
}

std::unique_ptr<debug::DebugChip> AvrTarget::debug_chip() {
    return debug::make_debug_chip(avr());
}

std::string AvrTarget::chip_json() {
    using Json = nlohmann::ordered_json;
    const avr::ChipReport report = avr().report();
    Json json;
    json["cycles"] = report.cycles;
    json["instructions"] = report.instructions;
    json["resets"] = Json::array();
    for (const avr::ResetRecord& reset : report.resets)
        json["resets"].push_back(board::with_place({{"time_s", seconds(reset.cycle)},
                                                    {"cause", std::string(avr::to_string(reset.cause))},
                                                    {"pc", hexadecimal(reset.pc)}},
                                                   avr().places(), reset.pc));
    json["unmodelled"] = Json::array();
    for (const avr::UnmodelledTouch& touch : report.unmodelled)
        json["unmodelled"].push_back({{"name", touch.name},
                                      {"address", hexadecimal(touch.address)},
                                      {"pc", hexadecimal(touch.pc)},
                                      {"access", touch.write ? "write" : "read"}});
    json["warnings"] = warnings();
    return json.dump();
}

std::string AvrTarget::chip_text() {
    const avr::ChipReport report = avr().report();
    std::string text = fmt::format("work: {} cycles, {} instructions\n", report.cycles, report.instructions);
    for (std::size_t i = 0; i < report.resets.size() && i < kShownOfAvr; ++i)
        text += fmt::format("reset: {} at {:.6f} s, {}\n", avr::to_string(report.resets[i].cause),
                            seconds(report.resets[i].cycle), avr::place_text(avr(), report.resets[i].pc));
    if (report.resets.size() > kShownOfAvr) text += fmt::format("resets: {} in all\n", report.resets.size());
    return text;
}

std::vector<std::string> AvrTarget::warnings() {
    const avr::ChipReport report = avr().report();
    std::vector<std::string> lines;
    if (const auto crash = avr::crash_text(avr(), report)) lines.push_back(*crash);
    if (const auto hang = avr().hang()) lines.push_back(*hang);
    for (const avr::ChipWarning& warning : report.warnings)
        lines.push_back(fmt::format("{}, at {}", warning.text, avr::place_text(avr(), warning.pc)));
    for (const avr::UnmodelledTouch& touch : report.unmodelled)
        lines.push_back(fmt::format(
            "{} {}, which no model is behind, at {}", touch.write ? "writes" : "reads",
            touch.name.empty() ? hexadecimal(touch.address) : touch.name, avr::place_text(avr(), touch.pc)));
    if (const auto refused = avr::refused_text(report)) lines.push_back(*refused);
    return lines;
}

}  // namespace puckloop::exec
