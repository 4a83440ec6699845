#pragma once
// A Linux program in a run: the program, and what its cameras look at.

#include "base/fields/field.h"
#include "linuxboard/shim/kernel/spec.h"
#include "physics/description/world_form.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

struct CameraViews {
    physics::World world{};
    std::size_t robot = 0;
    std::vector<std::string> kinds{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("world", &CameraViews::world, "what is seen").required().as<physics::WorldForm>(),
                     field("robot", &CameraViews::robot, "number of the robot in the world").required(),
                     field("kinds", &CameraViews::kinds, "of each camera: omni or front").required());
    }
};
static_assert(lists_all_fields<CameraViews>);

struct LinuxProgram {
    static constexpr std::string_view kKind = "linux";

    linuxboard::LinuxSpec program{};
    std::optional<CameraViews> scenery{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(part(&LinuxProgram::program),
                     field("scenery", &LinuxProgram::scenery, "of the cameras; none: there are none"));
    }
};
static_assert(lists_all_fields<LinuxProgram>);

}  // namespace puckloop::tools
