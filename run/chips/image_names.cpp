#include "run/chips/image_names.h"

#include "emu/avr/devices/device.h"
#include "emu/image/avr_image.h"

#include <utility>

namespace puckloop::tools {

ImageNames names_in(const std::string& firmware, bool avr) {
    if (!avr) return {image::load_image(firmware).symbols, image::source_lines(firmware)};
    image::AvrImage image = image::load_avr_image(firmware, avr::atmega1284p().image_part());
    return {std::move(image.symbols), std::move(image.lines)};
}

}  // namespace puckloop::tools
