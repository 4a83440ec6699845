#pragma once
// A robot's main board in a run: the board, and its camera with what that looks at.

#include "base/fields/field.h"
#include "emu/pic/pic_spec.h"
#include "physics/description/world_form.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::tools {

struct BoardCamera {
    std::string model;
    bool turned = false;
    physics::World world{};
    std::size_t robot = 0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("model", &BoardCamera::model, "po3030k, po6030k or po8030d").required(),
                     field("turned", &BoardCamera::turned, "it lies on its side, as on early boards"),
                     field("world", &BoardCamera::world, "what it sees").required().as<physics::WorldForm>(),
                     field("robot", &BoardCamera::robot, "number of its robot in the world").required());
    }
};
static_assert(lists_all_fields<BoardCamera>);

struct MainBoard {
    static constexpr std::string_view kKind = pic::PicSpec::kKind;

    pic::PicSpec board{};
    std::optional<BoardCamera> camera{};
    std::string camera_log{};
    std::optional<double> i2c_hertz{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(part(&MainBoard::board), field("camera", &MainBoard::camera, "on the board; none: none"),
                     field("camera_log", &MainBoard::camera_log, "file for a line per picture; empty: none")
                         .not_in(Comparison::State),
                     field("i2c_hertz", &MainBoard::i2c_hertz,
                           "with a camera or as a slave: no master on the bus is faster; one that is gets "
                           "its answers as if it were not")
                         .in("Hz"));
    }
};
static_assert(lists_all_fields<MainBoard>);

}  // namespace puckloop::tools
