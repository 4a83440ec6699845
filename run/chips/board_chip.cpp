#include "run/chips/board_chip.h"

#include "emu/avr/chip/chip.h"
#include "emu/dspic/chip/chip.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "emu/tam_avr/tam_node.h"
#include "run/chips/board_around.h"

namespace puckloop::tools {

BoardChip chip_of(cosim::Node& board) {
    const auto found = [](auto& node, auto& chip) {
        return BoardChip{debug::make_debug_chip(chip), &chip.clock(), [&node] { return node.granted(); },
                         [&node](std::vector<cosim::Message>& outbox) { node.press_reset(outbox); }};
    };
    if (auto* pic = dynamic_cast<pic::PicNode*>(&board)) return found(*pic, pic->chip());
    if (auto* rab = dynamic_cast<rab::RabNode*>(&board)) return found(*rab, rab->chip());
    if (auto* tam = dynamic_cast<tam::TamNode*>(&board)) return found(*tam, tam->board().chip());
    if (auto* around = dynamic_cast<BoardAround*>(&board)) return chip_of(around->board());
    return {};
}

}  // namespace puckloop::tools
