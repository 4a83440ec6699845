// The chips and boards that may lie on the bench, by the names that the command line takes.

#include "base/error.h"
#include "base/text/suggest.h"
#include "bench/targets/target.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/pin_table.h"
#include "emu/tam_avr/pin_table.h"

#include <fmt/format.h>

#include <array>

namespace puckloop::exec {

namespace {

/// A row without maker is a chip alone.
struct Row {
    std::string_view name;
    std::unique_ptr<Target> (*make)(const TargetOptions&, TargetListener&);
    TargetDefaults defaults;
};

constexpr double kEpuckCrystal = 7'372'800.0;
using Baud = std::array<double, 2>;
constexpr Baud kNominalBaud{115200, 115200}, kRabBaud{57600, 57600}, kTamBaud{57600, 9600};
constexpr double kAvrCrystal = 16e6;
constexpr std::string_view k30F = "dspic30f6014a", k33F = "dspic33fj256gp710", kAvr = "atmega1284p";

constexpr std::array kRows{
    Row{k30F, nullptr, {k30F, kEpuckCrystal, kNominalBaud, pic::PicNodeOptions::kFoscXtPll8}},
    Row{k33F, nullptr, {k33F, rab::kCrystalHertz, kNominalBaud, std::nullopt}},
    Row{kAvr, nullptr, {kAvr, kAvrCrystal, kNominalBaud, std::nullopt}},
    Row{"pic", make_pic_target, {k30F, kEpuckCrystal, kNominalBaud, pic::PicNodeOptions::kFoscXtPll8}},
    Row{"rab", make_rab_target, {k33F, rab::kCrystalHertz, kRabBaud, std::nullopt}},
    Row{"tam", make_tam_target, {kAvr, tam::kResonatorHertz, kTamBaud, std::nullopt}},
};

const Row& row_of(std::string_view name, bool board) {
    std::vector<std::string_view> known;
    std::string list;
    for (const Row& row : kRows) {
        if ((row.make != nullptr) != board) continue;
        if (row.name == name) return row;
        known.push_back(row.name);
        list += fmt::format("{}{}", list.empty() ? "" : " or ", row.name);
    }
    const std::string near = nearest_name(name, known);
    if (!near.empty()) list += fmt::format("; did you mean {}?", near);
    throw InputError("", board ? "--board" : "--mcu",
                     fmt::format("no {} '{}'", board ? "board" : "chip", name), list);
}

}  // namespace

TargetDefaults defaults_of(std::string_view mcu, std::string_view board) {
    return (mcu.empty() ? row_of(board, true) : row_of(mcu, false)).defaults;
}

std::unique_ptr<Target> make_board(std::string_view board, const TargetOptions& options,
                                   TargetListener& listener) {
    return row_of(board, true).make(options, listener);
}

}  // namespace puckloop::exec
