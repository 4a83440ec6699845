// Hosts for which no code is made: everything is interpreted.

#include "emu/dspic/translate/library.h"

namespace puckloop::dspic::translate {

Library* library_for(const Machine&) {
    return nullptr;
}

std::uint32_t block_at(Library&, Machine&, std::uint32_t) {
    return 0;
}

chip::Left enter(const Library&, Machine&, std::uint32_t) {
    return chip::Left::Slow;
}

}  // namespace puckloop::dspic::translate
