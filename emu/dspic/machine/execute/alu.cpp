#include "emu/dspic/machine/execute/arithmetic.h"

namespace puckloop::dspic {

bool bind_alu(Op& op, const Form& form, std::uint32_t word) {
    return with_arithmetic(form.id, [&](auto semantics) { semantics.bind(op, form, word); });
}

}  // namespace puckloop::dspic
