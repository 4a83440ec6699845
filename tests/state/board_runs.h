#pragma once
// Board nodes for the tests of saved states: made from images or from random programs, fed with random
// inputs.

#include "base/random.h"
#include "cosim/core/stateful_node.h"
#include "emu/image/image.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tests {

/// Makes a fresh board; each is the same.
using MakeBoard = std::function<std::unique_ptr<cosim::StatefulNode>()>;

/// `skip_idle` off: every cycle of waiting loops is executed.
MakeBoard pic_board(const image::Image& image, bool skip_idle = true);
MakeBoard rab_board(const image::Image& image, bool skip_idle = true);

/// The own firmware of the two boards.
image::Image own_pic_image();
image::Image own_rab_image();
/// A file of PUCKLOOP_IMAGES, if it is there.
std::optional<image::Image> real_image(const std::string& name);
/// Initialised registers, a random vector table, then random defined instruction words: they write registers
/// of every module, trap, reset, sleep, program flash.
image::Image random_program(RandomStream& random, bool family_33f);

/// It waits in loops and idle, computes with hardware loops and modulo addressing, erases and writes flash,
/// runs what it wrote there, and resets itself every eighth round.
image::Image self_programming(bool family_33f);

/// Characters at wrong and right rates on both UARTs and changes of every signal, over from..until, by time.
/// `busy`: mean number of messages a second.
std::vector<cosim::Message> random_inputs(RandomStream& random, cosim::Time from, cosim::Time until,
                                          double busy, std::size_t signals);
inline constexpr std::size_t kPicSignals = 60, kRabSignals = 40;

/// What comes in from outside over a stretch of time, and where the grants are cut.
struct Stretch {
    cosim::Time until = 0;
    std::vector<cosim::Message> inbox;
    std::vector<cosim::Time> cuts;
};
/// Two grants to five.
Stretch random_stretch(RandomStream& random, cosim::Time from, cosim::Time until, double busy,
                       std::size_t signals);
/// What the node sends meanwhile.
std::vector<cosim::Message> run(cosim::Node& node, const Stretch& outside);
/// They promise the same on every port.
bool same_future(const cosim::Node& a, const cosim::Node& b);

std::vector<std::uint8_t> saved(const cosim::StatefulNode& node);
std::unique_ptr<cosim::StatefulNode> loaded(const MakeBoard& make, const std::vector<std::uint8_t>& bytes);

}  // namespace puckloop::tests
