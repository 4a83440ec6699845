#pragma once

#include "emu/chip/translate/translated.h"

namespace puckloop::dspic {

namespace translate {
class Library;
}
using Translated = chip::Translated<translate::Library>;

}  // namespace puckloop::dspic
