#include "emu/dspic/machine/execute/shifts.h"

namespace puckloop::dspic {

bool bind_shift(Op& op, const Form& form, std::uint32_t word) {
    return with_shift(form.id, [&](auto semantics) { semantics.bind(op, form, word); });
}

}  // namespace puckloop::dspic
