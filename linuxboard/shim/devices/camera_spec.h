#pragma once
// What a run states of a camera of the Linux board.

#include "base/fields/field.h"

#include <cstdint>
#include <string>

namespace puckloop::linuxboard {

/// A camera of the board. What it sees comes from whoever made the node.
struct CameraSpec {
    std::string device = "/dev/video0";
    std::string card = "e-puck camera";
    std::string log;
    std::string save;
    std::uint32_t save_every = 1;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("device", &CameraSpec::device, "its file"),
                     field("card", &CameraSpec::card, "as VIDIOC_QUERYCAP gives it"),
                     field("log", &CameraSpec::log, "CSV file with a line per frame; empty: none"),
                     field("save", &CameraSpec::save, "folder for the pictures; empty: none are kept"),
                     field("save_every", &CameraSpec::save_every, "keep one of so many").at_least(1));
    }
};
static_assert(lists_all_fields<CameraSpec>);

}  // namespace puckloop::linuxboard
