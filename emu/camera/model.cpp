#include "emu/camera/model.h"

#include <algorithm>
#include <array>

namespace puckloop::camera {

namespace {

struct Chip {
    std::string_view name;
    Registers (*defaults)();
    VideoMode (*mode)(const Registers& registers);
};
// In the order of Model.
constexpr std::array kChips{Chip{"po3030k", po3030k_defaults, po3030k_mode},
                            Chip{"po6030k", po6030k_defaults, po6030k_mode},
                            Chip{"po8030d", po8030d_defaults, po8030d_mode}};

const Chip& chip(Model model) {
    return kChips[static_cast<std::size_t>(model)];
}

}  // namespace

std::string_view name_of(Model model) {
    return chip(model).name;
}

std::optional<Model> model_of(std::string_view name) {
    for (std::size_t i = 0; i < kChips.size(); ++i)
        if (name == kChips[i].name) return static_cast<Model>(i);
    return std::nullopt;
}

Registers defaults_of(Model model) {
    return chip(model).defaults();
}

VideoMode mode_of(Model model, const Registers& registers) {
    constexpr std::uint32_t kLeastWidth = 400, kLeastHeight = 100;  // at least 5 ms a frame
    VideoMode mode = chip(model).mode(registers);
    mode.frame_width = std::max(mode.frame_width, kLeastWidth);
    mode.frame_height = std::max(mode.frame_height, kLeastHeight);
    return mode;
}

}  // namespace puckloop::camera
