#include "replay/chip_view.h"

#include "base/error.h"
#include "cosim/resume/resumed_node.h"
#include "emu/avr/chip/chip_faults.h"
#include "emu/avr/devices/device.h"
#include "emu/dspic/chip/chip_faults.h"
#include "emu/image/symbol_sizes.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "emu/tam_avr/tam_node.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

using image::Symbol;

ChipView dspic_view(dspic::Chip& chip) {
    ChipView view;
    view.name = chip.inside().device.name;
    view.clock = &chip.clock();
    view.chip = std::make_unique<dspic::ChipFaults>(chip);
    return view;
}

std::map<std::string, Variable> variables_of(const std::map<std::string, Symbol>& symbols,
                                             const std::string& file) {
    const auto sizes = image::symbol_sizes(file);
    std::map<std::string, Variable> variables;
    for (const auto& [name, symbol] : symbols) {
        if (symbol.space != image::Space::Data) continue;
        const auto size = sizes.find(name);
        variables[name] = {symbol.address, size == sizes.end() ? 0 : size->second};
    }
    return variables;
}

}  // namespace

ChipView view_of(const NodeDescription& spec, cosim::Node& node) {
    if (auto* resumed = dynamic_cast<cosim::ResumedNode*>(&node)) {
        ChipView view = view_of(spec, resumed->board());
        view.lives_from = resumed->lives_from();
        return view;
    }
    cosim::Node* inner = &node;
    NodeDescription copy = spec;
    const std::string file = has_board(spec) ? board_fields(copy).firmware : "";
    if (auto* pic = dynamic_cast<pic::PicNode*>(inner)) {
        ChipView view = dspic_view(pic->chip());
        view.variables = variables_of(image::load_image(file).symbols, file);
        return view;
    }
    if (auto* rab = dynamic_cast<rab::RabNode*>(inner)) {
        ChipView view = dspic_view(rab->chip());
        view.variables = variables_of(image::load_image(file).symbols, file);
        return view;
    }
    if (auto* tam = dynamic_cast<tam::TamNode*>(inner)) {
        avr::Chip& chip = tam->board().chip();
        ChipView view;
        view.name = avr::atmega1284p().name;
        view.clock = &chip.clock();
        view.origin = cosim::from_seconds(std::get<tam::TamSpec>(spec.kind).start);
        view.cell_bytes = 1;
        view.chip = std::make_unique<avr::ChipFaults>(chip);
        view.variables =
            variables_of(image::load_avr_image(file, avr::atmega1284p().image_part()).symbols, file);
        return view;
    }
    throw InputError("", "--registers", fmt::format("{} has no chip", node.name()),
                     "a main board, a range-and-bearing board or a TAM");
}

}  // namespace puckloop::tools
