#include "emu/camera/model.h"

#include <algorithm>

namespace puckloop::camera {

std::string_view name_of(Model model) {
    return model == Model::Po3030k ? "po3030k" : "po6030k";
}

std::optional<Model> model_of(std::string_view name) {
    for (const Model model : {Model::Po3030k, Model::Po6030k})
        if (name == name_of(model)) return model;
    return std::nullopt;
}

VideoMode mode_of(Model model, const Registers& registers) {
    constexpr std::uint32_t kLeastWidth = 400, kLeastHeight = 100;  // at least 5 ms a frame
    VideoMode mode = model == Model::Po3030k ? po3030k_mode(registers) : po6030k_mode(registers);
    mode.frame_width = std::max(mode.frame_width, kLeastWidth);
    mode.frame_height = std::max(mode.frame_height, kLeastHeight);
    return mode;
}

}  // namespace puckloop::camera
