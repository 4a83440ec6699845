#include "emu/chip/translate/translation_switch.h"

#include <atomic>

namespace puckloop::chip {

namespace {

std::atomic<bool> wanted{true};
std::atomic<std::uint8_t> wanted_hot{kHot};

}  // namespace

void set_translation(bool on, std::uint8_t hot) {
    wanted = on;
    wanted_hot = hot;
}

Translation translation() {
    return {wanted, wanted_hot};
}

}  // namespace puckloop::chip
