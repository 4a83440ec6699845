#pragma once
// Cores made while it lives translate as it states.

#include "emu/chip/translate/translation_switch.h"

namespace puckloop::tests {

class TranslationGuard {
  public:
    explicit TranslationGuard(bool on, std::uint8_t hot = 1) { chip::set_translation(on, hot); }
    ~TranslationGuard() { chip::set_translation(true); }
    TranslationGuard(const TranslationGuard&) = delete;
    TranslationGuard& operator=(const TranslationGuard&) = delete;
};

}  // namespace puckloop::tests
