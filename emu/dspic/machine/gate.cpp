#include "emu/dspic/machine/gate.h"

#include "emu/dspic/machine/machine.h"

#include <algorithm>
#include <array>

namespace puckloop::dspic {

namespace {

/// By form: the operand f is a data address.
const std::array<bool, 256> kFileForms = [] {
    std::array<bool, 256> all{};
    for (const Form& form : forms())
        all[static_cast<std::size_t>(form.id)] = form.has_field('f');
    return all;
}();

/// Neither do its modifications by an instruction lead to a register.
bool points_to_ram(std::uint16_t pointer) {
    constexpr std::uint16_t kFarthest = 8, kEnd = 0x8000 - kFarthest;
    return pointer >= kRamStart + kFarthest && pointer < kEnd;
}

}  // namespace

bool may_access(const Machine& m, const Op* op) {
    // Not decoded yet, a mark that changes what it does, offsets that are sums, or a reset.
    if (op->form == kNoForm || op->marks != 0 || op->source == Ea::Offset || op->destination == Ea::Offset ||
        op->form == FormId::RESET)
        return true;
    if (kFileForms[static_cast<std::size_t>(op->form)] && op->k < kRamStart &&
        m.gate.registers->test(op->k / 2u))
        return true;
    if (!points_to_ram(m.st.w[15])) return true;
    const std::uint32_t pointers = op->uses >> 16;
    const bool displaced = op->form == FormId::MOV_WsOffset_Wnd || op->form == FormId::MOV_Wns_WdOffset;
    if (displaced) {
        const int pointer = op->form == FormId::MOV_WsOffset_Wnd ? op->s : op->d;
        return !points_to_ram(static_cast<std::uint16_t>(m.st.w[static_cast<std::size_t>(pointer)] + op->k));
    }
    for (std::uint32_t rest = pointers; rest != 0; rest &= rest - 1)
        if (!points_to_ram(m.st.w[static_cast<std::size_t>(std::countr_zero(rest))])) return true;
    return false;
}

}  // namespace puckloop::dspic
