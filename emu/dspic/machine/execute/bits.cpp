#include "emu/dspic/machine/execute/bits.h"

namespace puckloop::dspic {

bool bind_bits(Op& op, const Form& form, std::uint32_t word) {
    return with_bits(form.id, [&](auto semantics) { semantics.bind(op, form, word); });
}

}  // namespace puckloop::dspic
