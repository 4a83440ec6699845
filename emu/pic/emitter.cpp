#include "emu/pic/emitter.h"

namespace puckloop::pic {

void Emitter::set(bool on, dspic::Cycle now) {
    if (on == on_) return;
    at_edge_ = intensity(now);
    edge_ = now;
    on_ = on;
}

}  // namespace puckloop::pic
