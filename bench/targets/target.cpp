// What a target with a dsPIC answers.

#include "bench/targets/target.h"

#include "debug/debug_chip.h"

#include "base/json.h"
#include "emu/board/chip_json.h"
#include "emu/board/chip_warnings.h"
#include "emu/board/nvm_file.h"
#include "emu/image/code_places.h"
#include "emu/image/device.h"

#include <fmt/format.h>

#include <stdexcept>

namespace puckloop::exec {

namespace {
constexpr std::size_t kShownOfBoard = 10;
}

dspic::Chip& Target::chip() {
    throw std::logic_error("this target has no dsPIC");
}

image::Image Target::read_image(const std::string& file, std::string_view mcu) {
    image::Image image = image::load_image(file);
    image::check_fits(image, image::find_device(mcu));
    return image;
}

void Target::load_kept(const image::Image& image, const board::NvmFile& nvm) {
    load(nvm.over(image));
}

void Target::save_memory(board::NvmFile& nvm) {
    nvm.save(chip().memory());
}

std::string Target::chip_json() {
    return board::chip_json(chip()).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::optional<std::string> Target::hang() {
    const std::optional<dspic::WaitReport> wait = chip().waiting();
    if (!wait || !wait->hung) return std::nullopt;
    return board::waiting_text(chip(), wait);
}

std::unique_ptr<debug::DebugChip> Target::debug_chip() {
    return debug::make_debug_chip(chip());
}

std::vector<std::string> Target::warnings() {
    return board::chip_warnings(chip());
}

std::string Target::chip_text() {
    const dspic::ChipReport report = chip().report();
    const auto seconds = [&](dspic::Cycle cycle) { return cosim::to_seconds(clock().time_of(cycle)); };
    std::string text = fmt::format("work: {} cycles, {} instructions\n", report.cycles, report.instructions);
    for (std::size_t i = 0; i < report.resets.size() && i < kShownOfBoard; ++i)
        text += fmt::format("reset: {} at {:.6f} s, pc 0x{:04x}{}\n", report.resets[i].cause,
                            seconds(report.resets[i].cycle), report.resets[i].pc,
                            chip().places().text(report.resets[i].pc));
    if (report.resets.size() > kShownOfBoard)
        text += fmt::format("resets: {} in all\n", report.resets.size());
    for (std::size_t i = 0; i < report.traps.size() && i < kShownOfBoard; ++i)
        text += fmt::format("trap: {} at {:.6f} s, pc 0x{:04x}{}\n", report.traps[i].name,
                            seconds(report.traps[i].cycle), report.traps[i].pc,
                            chip().places().text(report.traps[i].pc));
    if (report.traps.size() > kShownOfBoard) text += fmt::format("traps: {} in all\n", report.traps.size());
    return text;
}

}  // namespace puckloop::exec
